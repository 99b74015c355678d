"""Problems with closed-form answers, by subject."""
