"""Single blocks: free flight, rotation, strain."""
