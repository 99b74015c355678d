"""How a case file is read, judged and written; what it may contain is said in clast.case."""
