"""Work-precision points -> cost of an error."""

import itertools
import math
from dataclasses import dataclass


@dataclass
class Point:
    """One solver with one method and tolerance on one case."""

    case: str
    solver: str
    method: str
    tolerance: float
    error: float  # greatest of theta, in alpha
    rhs: int
    steps: int
    events: int
    cpu: float  # s


def best(points, quantity):
    """Returns the points that no other beats in both error and work, from the cheapest on."""
    kept = []
    for point in sorted(points, key=lambda point: (getattr(point, quantity), point.error)):
        if math.isfinite(point.error) and (not kept or point.error < kept[-1].error):
            kept.append(point)
    return kept


def cost(points, error, quantity):
    """Returns one method's work for an error, interpolated between the logarithms of its best points.

    None if the method is never that accurate; the cheapest point's work if all points are more accurate.
    """
    kept = best(points, quantity)
    if not kept or kept[-1].error > error:
        return None
    if kept[0].error <= error:
        return float(getattr(kept[0], quantity))
    for worse, better in itertools.pairwise(kept):
        if better.error <= error:
            part = math.log(worse.error / error) / math.log(worse.error / better.error)
            low, high = getattr(worse, quantity), getattr(better, quantity)
            return low * (high / low) ** part
    raise AssertionError("unreachable: the last is accurate enough")


def cheapest(points, error, quantity):
    """Returns the least cost among these methods, and its method; (None, None) if none is that accurate."""
    costs = {}
    for method in sorted({point.method for point in points}):
        value = cost([point for point in points if point.method == method], error, quantity)
        if value is not None:
            costs[method] = value
    if not costs:
        return None, None
    method = min(costs, key=costs.get)
    return costs[method], method
