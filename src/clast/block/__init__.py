"""One block: its polygon, how it moves and strains, its inertia and its elasticity."""
