"""Files of Shi's programs and of DDA for Windows, read only: geometry, analysis, blocks."""
