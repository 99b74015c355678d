"""What runs are judged by: measures of their results, and expressions of these."""
