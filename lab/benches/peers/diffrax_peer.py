"""Blocks on the rigid base by diffrax: all of an ensemble at once (`vmap`), each arc to the next impact by a call with a terminal event."""

import os

# On one core, as the other solvers.
os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")

import diffrax  # noqa: E402
import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
import optimistix  # noqa: E402

jax.config.update("jax_enable_x64", True)


class Peer:
    """Blocks of slenderness `alpha` (rad) under a one-sine pulse of this period (s) that begins so that they lift at once, until `end` (s).

    y is the rotation away from the base, and `side` the side to which a block tilts. The root finder that locates an impact has to be
    named: without one an event ends the step after it.
    """

    def __init__(self, alpha, period, end, gravity, tolerance):
        restitution = 1.0 - 1.5 * np.sin(alpha) ** 2
        slowest = alpha * np.sqrt(2.0 * tolerance)
        locate = optimistix.Newton(rtol=1e-12, atol=1e-12)
        impact = diffrax.Event(lambda t, y, args, **_: y[0], locate, direction=False)
        controller = diffrax.PIDController(rtol=tolerance, atol=tolerance * alpha)

        def rate(t, state, parameters):
            y, v = state
            p2, side, amplitude = parameters
            ground = side * amplitude * jnp.sin(2.0 * jnp.pi / period * t) / gravity
            return v, -p2 * (jnp.sin(alpha - y) + jnp.cos(alpha - y) * ground)

        def run(amplitude, p):
            def arc(carry):
                t, y, v, side = carry
                pulse = t < period
                solution = diffrax.diffeqsolve(
                    diffrax.ODETerm(rate),
                    diffrax.Dopri8(),
                    t,
                    jnp.where(pulse, period, end),
                    None,
                    (y, v),
                    (p * p, side, jnp.where(pulse, amplitude, 0.0)),
                    stepsize_controller=controller,
                    event=impact,
                    adjoint=diffrax.ForwardMode(),
                    max_steps=100_000,
                )
                t, y, v = solution.ts[-1], solution.ys[0][-1], solution.ys[1][-1]
                hit = diffrax.is_event(solution.result)
                y, v, side = jnp.where(hit, 0.0, y), jnp.where(hit, -restitution * v, v), jnp.where(hit, -side, side)
                return jnp.where(hit & (v < slowest * p), end, t), y, v, side

            def goes_on(carry):
                t, y, *_ = carry
                return (t < end) & (jnp.abs(y) < jnp.pi / 2)

            begin = jnp.arcsin(gravity * jnp.tan(alpha) / amplitude) * period / (2.0 * jnp.pi)
            _, y, _, side = jax.lax.while_loop(goes_on, arc, (begin, 0.0, 0.0, -1.0))
            return y * side

        self.compiled = jax.jit(jax.vmap(run, (None, 0)))

    def run(self, amplitude, sizes):
        """Returns the rotations of blocks of these frequency parameters at the end. The first call for a number of blocks compiles."""
        return np.asarray(self.compiled(amplitude, sizes))
