"""Records of earthquakes: their files, their units, and the motion of the ground they stand for.

Nothing here knows the case file: text in, arrays out, faults as CaseError with file and line.
"""
