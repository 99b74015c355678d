"""Pictures of a cut: its joints and rocks, its statistics, and a page with all of it."""

from clast.pictures.rock_mass.cut_page import write_cut_report
from clast.pictures.rock_mass.cut_statistics import plot_cut_statistics
from clast.pictures.rock_mass.section import plot_cut

__all__ = ["plot_cut", "plot_cut_statistics", "write_cut_report"]
