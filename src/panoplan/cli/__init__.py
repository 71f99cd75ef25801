"""Parse, call a library function, print.

A command imports what it runs when it runs, so that a mistyped one is told at once.
"""
