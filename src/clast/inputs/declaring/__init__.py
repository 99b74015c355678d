"""How an input is declared: its table, its ranges, the messages of its faults."""
