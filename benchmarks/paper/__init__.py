"""The paper's studies, run with every process and law: ``make paper`` writes docs/paper.md.

A file here is a study: its jobs, a run each, and its section of the page.  Every number on the page
comes from the runs that write it.
"""
