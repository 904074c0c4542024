"""Right answers made in other ways than the reference; `autograder.mistakes` finds them by their names."""
