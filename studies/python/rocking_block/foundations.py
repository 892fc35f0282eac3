"""Friction, restitution and supports of usual foundations, each with its source.

The values are those of `rocking foundations`. They are starting points: their spread is that of the sources.

    steel = rb.foundations.pairs("friction", "steel on concrete")
    support = rb.foundations.soil(width=2, length=3, shear_wave_velocity=200, density=1800, poisson=0.3)
    block = rb.Block(width=2, height=8, K=support.K, C=support.C, mass=40000)
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal, get_args

from rocking_block import _engine
from rocking_block._words import chosen, number

__all__ = ["Pair", "Support", "pad", "pairs", "soil"]

Quantity = Literal["friction", "restitution_factor"]
Kind = Literal["measured", "lowest", "design"]


@dataclass(frozen=True)
class Pair:
    """A value of a pair of surfaces, from one source.

    Attributes
    ----------
    quantity : {"friction", "restitution_factor"}
        Coulomb's coefficient of friction [1], or e over Housner's e [1].
    surfaces, state : str
        The surfaces, the block's first, and their state or the sizes of the blocks.
    low, high : float
        Least and greatest value, equal if the source has one [1].
    kind : {"measured", "lowest", "design"}
        The spread of tests, the least value of tests, or a standard's value or limits; a single one is on the safe side
        where friction helps.
    basis : str
        What the values are.
    source, citation : str
        Short name of the source; authors, title and year.
    doi : str or None
        Its digital object identifier, if known.
    """

    quantity: Quantity
    surfaces: str
    state: str
    low: float
    high: float
    kind: Kind
    basis: str
    source: str
    citation: str
    doi: str | None


@dataclass(frozen=True)
class Support:
    """One of the two supports of a block.

    Attributes
    ----------
    K : float
        Stiffness, half the vertical stiffness of the foundation [N/m].
    C : float
        Damping, half the vertical damping [N s/m]; nan if the source does not state it.
    K_rocking : float
        Support stiffness that would give the rocking stiffness of the foundation [N/m].
    """

    K: float
    C: float
    K_rocking: float


def pairs(quantity: Quantity | None = None, surfaces: str = "") -> list[Pair]:
    """Returns friction and restitution of pairs of surfaces.

    Parameters
    ----------
    quantity : {"friction", "restitution_factor"}, optional
        Only this quantity.
    surfaces : str
        Only pairs whose surfaces contain this text.

    Examples
    --------
    >>> import rocking_block as rb
    >>> for pair in rb.foundations.pairs("friction", "steel on concrete or grout"):
    ...     print(pair.low, pair.high, pair.kind, pair.source)
    0.57 0.7 measured Rabbat and Russell (1985)
    """
    wanted = None if quantity is None else chosen("quantity", quantity, get_args(Quantity))
    found = [_pair(**row) for row in json.loads(_engine.foundation_pairs())]
    return [pair for pair in found if wanted in (None, pair.quantity) and surfaces.lower() in pair.surfaces]


def _pair(source: dict[str, Any], **row: Any) -> Pair:
    return Pair(**row, source=source["name"], citation=source["citation"], doi=source["doi"])


def pad(diameter: float, shape_factor: float, shear_modulus: float, bulk_modulus: float | None = None) -> Support:
    """Returns the support that a circular rubber pad under each corner is: K = 6 π d G S³.

    This is eq. (36) of Palmeri & Makris (2008). With a bulk modulus the rubber is compressible, after Gent & Lindley (1959).
    The damping is nan: take ξ_v from a test of the pads.

    Parameters
    ----------
    diameter : float
        Diameter d [m].
    shape_factor : float
        Shape factor S [1]: loaded area over the area that is free to bulge; d/(4 t) for a layer of thickness t.
    shear_modulus : float
        Shear modulus G of the rubber [Pa].
    bulk_modulus : float, optional
        Bulk modulus of the rubber [Pa]; by default it is incompressible.

    Raises
    ------
    ValueError
        A value that is not positive; the message names it.

    Examples
    --------
    >>> import rocking_block as rb
    >>> rb.foundations.pad(diameter=2, shape_factor=5, shear_modulus=1e6).K
    4712388980.384689
    """
    bulk = None if bulk_modulus is None else number("bulk_modulus", bulk_modulus)
    sizes = (number("diameter", diameter), number("shape_factor", shape_factor), number("shear_modulus", shear_modulus))
    return Support(*_engine.pad_support(*sizes, bulk))


def soil(width: float, length: float, *, shear_wave_velocity: float, density: float, poisson: float) -> Support:
    """Returns the supports equivalent to a rigid footing on the surface of a half-space of soil.

    Static stiffnesses and the radiation damping of the vertical motion after Pais & Kausel (1988), for full contact.

    Parameters
    ----------
    width, length : float
        Sides of the footing, in the plane of rocking and across it [m].
    shear_wave_velocity : float
        Velocity V_s of shear waves, at the strain of the earthquake [m/s].
    density : float
        Density of the soil [kg/m³].
    poisson : float
        Poisson's ratio of the soil [1], 0 to less than 0.5.

    Raises
    ------
    ValueError
        A value out of range; the message names it.

    Examples
    --------
    >>> import rocking_block as rb
    >>> support = rb.foundations.soil(2, 3, shear_wave_velocity=200, density=1800, poisson=0.3)
    >>> f"{support.K:.4g} {support.C:.4g} {support.K_rocking / support.K:.3f}"
    '2.984e+08 2.02e+06 0.965'
    """
    given = {"width": width, "length": length, "shear_wave_velocity": shear_wave_velocity, "density": density, "poisson": poisson}
    return Support(*_engine.soil_support(*(number(name, value) for name, value in given.items())))
