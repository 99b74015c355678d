"""The block-sparse equations K d = F: assembled, ordered, factorised, iterated."""
