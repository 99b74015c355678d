"""Problems with closed-form answers, by what they verify."""
