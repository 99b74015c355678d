"""What a result file keeps of the parts of a model, a file for each of them."""
