"""A single block: free flight, rotation, strain."""
