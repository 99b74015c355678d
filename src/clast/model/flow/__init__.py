"""Flow of water in joints: network, apertures, and the balance of water at its nodes."""
