"""Films of runs: MP4, animated GIF and WebP."""
