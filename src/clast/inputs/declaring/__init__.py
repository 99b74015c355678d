"""How an input is declared: its table, its ranges, what is said of its faults."""
