"""Figures held to their limits; the module of the tests beside it."""
import sys

wrong = []


def held(name, value, expected, tolerance):
    fits = abs(value / expected - 1) <= tolerance
    print(f"{'pass' if fits else 'FAIL'}  {name}: {value:.6g}, expected {expected:.6g} within {100 * tolerance:g} %")
    if not fits:
        wrong.append(name)


def finish():
    sys.exit(bool(wrong))
