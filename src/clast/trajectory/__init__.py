"""Paths of rigid rocks over a profile: free flight, blows, sliding, rolling and rest.

A rock is a convex polygon, the profile a line of segments with surfaces.  Rocks do not meet each
other.  Flights are parabolas to the next blow, whose time is found between bounds of the gap's
second derivative (flight.py); blows are those of rigid bodies with Coulomb's friction (impact.py);
a rock in contact with the profile moves by an energy-conserving midpoint rule (bearing.py).
"""
