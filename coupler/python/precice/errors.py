"""What a solver's calls get wrong, or what Strake does not have."""


class Error(RuntimeError):
    """A call that cannot be carried out: the function, what is wrong, what was expected."""
