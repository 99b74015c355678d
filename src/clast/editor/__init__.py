"""`clast edit`: a case file as a browser edits it; the file stays the truth."""
