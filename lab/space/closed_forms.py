#!/usr/bin/env python3
"""The block in space beside closed forms of rigid bodies: static barrier by azimuth, rectangular pulses, a wobbling cylinder.

    python lab/space/closed_forms.py

Needs the Python package `rocking_block` alone, and two minutes of CPU time. docs/studies/space.md has the results and the derivations.
"""

import numpy as np

import rocking_block as rb

G = 9.81


def barrier() -> None:
    """A horizontal acceleration that grows slowly and stays: the least one that overturns, over the closed form, by azimuth."""
    half_width, half_depth, height = 0.25, 0.4, 1.0
    # It grows for 30 s, stays for half a minute, and ends at zero.
    shape = np.clip(np.arange(120) * 0.5 / 30.0, 0.0, 1.0)
    shape[-1] = 0.0
    record = rb.Record(shape * G, 0.5)
    corner = np.degrees(np.arctan2(half_depth, half_width))
    print("\nstatic barrier: azimuth (°), closed form (g), least acceleration over it with η = 100 and 300")
    for azimuth in (0.0, 15.0, 30.0, 45.0, corner, 75.0, 90.0):
        sin, cos = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
        exact = min(half_width / max(cos, 1e-9), half_depth / max(sin, 1e-9)) / height
        ratios = []
        for eta in (100, 300):
            block = rb.BlockInSpace(width=2 * half_width, depth=2 * half_depth, center_height=height, eta=eta, xi_v=0.5)
            found = rb.search_overturning(
                block, record=record, azimuth=azimuth, from_=0.9 * exact, to=1.1 * exact, points=9, resolution=1e-5
            )
            ratios.append(found.least / exact)
        print(f"{azimuth:5.1f}  {exact:.4f}  " + "  ".join(f"{ratio:.4f}" for ratio in ratios))


def pulses() -> None:
    """Rectangular pulses along both axes of a base: the least amplitude, over that of slender rigid blocks."""
    alpha, height, ratio = 0.1, 1.0, 2.0
    half_width = height * np.tan(alpha)
    print("\nrectangular pulse: axis, p t, closed form (g), least amplitude over it with η = 100, 300, 1000; planar rigid block over it")
    for axis, half, azimuth in (("x", half_width, 0.0), ("y", ratio * half_width, 90.0)):
        radius = np.hypot(half, height)
        p = np.sqrt(0.75 * G / radius)
        planar = rb.Block(alpha=float(np.arctan2(half, height)), p=float(p), foundation="rigid")
        for duration in (0.5, 1.0, 2.0):
            exact = G * np.arctan2(half, height) / (1.0 - np.exp(-duration))
            pulse = rb.Pulse("rectangular", period=duration / p)
            scan = {"pulse": pulse, "from_": 0.85 * exact, "to": 1.1 * exact, "points": 11, "resolution": 1e-4}
            ratios = []
            for eta in (100, 300, 1000):
                # η of the block is that of its motion along x; here it is that along the axis.
                of_x = np.sqrt(0.75 * G / np.hypot(half_width, height))
                block = rb.BlockInSpace(width=2 * half_width, depth_ratio=ratio, center_height=height, eta=eta * p / of_x, xi_v=0.2)
                ratios.append(rb.search_overturning(block, azimuth=azimuth, **scan).least / exact)
            ratios.append(rb.search_overturning(planar, **scan).least / exact)
            print(f"{axis}  {duration:3.1f}  {exact / G:.4f}  " + "  ".join(f"{ratio:.3f}" for ratio in ratios))


def precession(radius: float, height: float, moment: float, mass: float, tilt: float) -> float:
    """Returns the rate at which the contact runs around a cylinder that wobbles at a constant tilt, without spin about its axis [rad/s]."""
    sin, cos = np.sin(tilt), np.cos(tilt)
    gravity = mass * G * (radius * cos - height * sin)
    return float(np.sqrt(gravity / (sin * (moment * cos + mass * height * (height * cos + radius * sin)))))


def wobble() -> None:
    """A cylinder on n feet begins in the steady wobble of one on its rim: duration of the first turn, and loss of energy in it."""
    radius, height, turns = 0.25, 1.0, 2
    tilt = 0.3 * np.arctan(radius / height)
    print("\nwobble at 0.3 α: η, number of feet, first turn over that of a rigid cylinder on its rim, energy lost in it (%)")
    for eta in (100, 300, 1000):
        for feet in (8, 16, 32, 64):
            block = rb.BlockInSpace(base="circle", feet=feet, width=2 * radius, center_height=height, eta=eta, xi_v=0.05)
            rate = precession(radius, height, block.inertia[0, 0], block.mass, tilt)
            period = 2 * np.pi / rate
            run = block.run(
                tilt_x=tilt,
                omega_x=-rate * np.sin(tilt) * np.cos(tilt),
                omega_z=rate * np.sin(tilt) ** 2,
                duration=turns * period,
                step=period / 400,
            )
            turned = np.unwrap(run["azimuth"]) / (2 * np.pi)
            first = np.interp(1.0, turned, run.t)
            lost = 1.0 - np.interp(1.0, turned, run["energy.total"]) / run["energy.total"][0]
            print(f"{eta:4d}  {feet:2d}  {first / period:.4f}  {100 * lost:.2f}")


if __name__ == "__main__":
    barrier()
    pulses()
    wobble()
