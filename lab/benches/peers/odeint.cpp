/*
 * Solves the block of block.h with Boost.odeint, as an engineer would: controlled steps, a sign test of the surfaces at the end of each,
 * the event by regula falsi over trial steps from the beginning of the step, stops at the kinks of the excitation.
 *
 *   odeint CASE METHOD TOLERANCE ensemble LEAST GREATEST COUNT    CPU time per block of a range of frequency parameters
 *
 * METHOD is dopri5, fehlberg78 or bulirsch-stoer. The state is divided by the scales that CVODE has as absolute tolerances.
 */
#include "block.h"

#include <array>

#include <boost/numeric/odeint.hpp>

namespace odeint = boost::numeric::odeint;

using State = std::array<double, 4>;

struct solver {
    double tolerance;
    enum at_samples at_samples;
    const char *method;
};

/* The equations of motion of a scaled state. */
struct System {
    struct run &run;
    State scale;

    void operator()(const State &x, State &rate, double t) const
    {
        run.rhs++;
        State y = unscaled(x), of_y{};
        run.equations(&run, t, y.data(), of_y.data());
        for (int i = 0; i < 4; i++)
            rate[i] = of_y[i] / scale[i];
    }

    State unscaled(const State &x) const
    {
        State y;
        for (int i = 0; i < 4; i++)
            y[i] = x[i] * scale[i];
        return y;
    }
};

/* The state some time after the beginning of a step. */
template <class Controlled>
static State after(Controlled &, const System &system, const State &x, double t, double size)
{
    /* A stepper of its own: dopri5's keeps its last rate. */
    typename Controlled::stepper_type stepper;
    State there;
    stepper.do_step(system, x, t, there, size);
    return there;
}

static State after(odeint::bulirsch_stoer<State> &controlled, const System &system, State x, double t, double size)
{
    if (size > 0.0)
        odeint::integrate_adaptive(controlled, system, x, t, t + size, size);
    return x;
}

/* The part of a step up to which a surface is not passed, to rounding. */
template <class Controlled>
static double before_event(Controlled &controlled, const System &system, const State &x, double t, double size, int surface, double low, double high)
{
    double from = 0.0, to = size, value[2];
    for (int i = 0; i < 100 && to - from > 1e-15 * (1.0 + t); i++) {
        double middle = from + (to - from) * low / (low - high);
        if (!(middle > from && middle < to) || i > 30)
            middle = 0.5 * (from + to);
        State y = system.unscaled(after(controlled, system, x, t, middle));
        surfaces(&system.run, t + middle, y.data(), value);
        /* Illinois: the end that stays weighs half. */
        if (value[surface] > 0.0)
            from = middle, low = value[surface], high *= 0.5;
        else if (value[surface] < 0.0)
            to = middle, high = value[surface], low *= 0.5;
        else
            return middle;
    }
    return to;
}

template <class Make>
static void simulate_by(struct run *run, const struct solver *solver, double *trace, Make make)
{
    const struct block *b = &run->block;
    const int rows = rows_of(b);
    System system{*run, {}};
    const double upright = b->r0 * b->alpha * b->p, frequency = b->rigid != 0.0 ? b->p : b->omega_v;
    system.scale = {b->alpha, b->alpha * b->p, upright / frequency, upright};
    State y{};
    int sample = 0, row = 0;
    double t = start(run, y.data());
    while (trace && row < rows && row * b->dt <= t)
        trace[row++] = y[0];
    double stop = next_piece(run, solver->at_samples, t, &sample);
    const double first = 1e-2 / frequency;
    double size = first;
    auto controlled = make();
    /* A quarter turn ends the run, as it does in this project. */
    while (t < b->t_end && fabs(y[0]) < M_PI_2) {
        State x, there;
        for (int i = 0; i < 4; i++)
            x[i] = y[i] / system.scale[i];
        double taken, value[2], here[2];
        bool last;
        for (int tries = 0;; tries++) {
            last = size >= stop - t;
            taken = last ? stop - t : size;
            double end = t, next = taken;
            there = x;
            odeint::controlled_step_result result = controlled.try_step(system, there, end, next);
            if (result == odeint::success) {
                size = last ? fmax(size, next) : next;
                break;
            }
            size = next;
            if (tries > 100)
                fail("no step is accurate enough at", t);
        }
        run->steps++;
        int count = surfaces(run, t, y.data(), here);
        State end = system.unscaled(there);
        surfaces(run, t + taken, end.data(), value);
        bool found[2] = {false, false};
        double part = taken;
        for (int i = 0; i < count; i++) {
            if (here[i] <= 0.0 || value[i] > 0.0)
                continue;
            double time = before_event(controlled, system, x, t, taken, i, here[i], value[i]);
            if (time < part || !(found[0] || found[1])) {
                part = time;
                found[0] = i == 0;
                found[1] = i == 1;
            }
        }
        while (trace && row < rows && row * b->dt <= t + part + 1e-12) {
            double size_to_row = fmin(row * b->dt - t, part);
            trace[row++] = system.unscaled(after(controlled, system, x, t, size_to_row))[0];
        }
        if (found[0] || found[1]) {
            y = system.unscaled(after(controlled, system, x, t, part));
            t += part;
            if (pass_events(run, found, t, y.data())) {
                controlled = make();
                size = first;
            }
            continue;
        }
        y = end;
        t = last ? stop : t + taken;
        if (last && t < b->t_end) {
            sample++;
            if (solver->at_samples == RESTART)
                size = first;
            stop = next_piece(run, solver->at_samples, t, &sample);
            controlled = make();
        }
    }
}

static void simulate(struct run *run, void *data, double *trace)
{
    const struct solver *solver = (const struct solver *)data;
    double tolerance = solver->tolerance;
    if (strncmp(solver->method, "dopri5", 6) == 0)
        simulate_by(run, solver, trace, [=] { return odeint::make_controlled<odeint::runge_kutta_dopri5<State>>(tolerance, tolerance); });
    else if (strncmp(solver->method, "fehlberg78", 10) == 0)
        simulate_by(run, solver, trace, [=] { return odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(tolerance, tolerance); });
    else if (strncmp(solver->method, "bulirsch-stoer", 14) == 0)
        simulate_by(run, solver, trace, [=] { return odeint::bulirsch_stoer<State>(tolerance, tolerance); });
    else
        fail("the method is dopri5, fehlberg78 or bulirsch-stoer", 0.0);
}

int main(int argc, char **argv)
{
    static struct run run;
    if (argc < 5)
        fail("usage: odeint CASE METHOD TOLERANCE time SECONDS | trace | ensemble LEAST GREATEST COUNT", argc);
    read_case(argv[1], &run.block);
    struct solver solver = {atof(argv[3]), at_samples_of(argv[2]), argv[2]};
    if (strcmp(argv[4], "ensemble") != 0)
        return answer(argc, argv, &run, &solver, simulate);
    if (argc < 8)
        fail("ensemble needs LEAST, GREATEST and COUNT", argc);
    double least = atof(argv[5]), greatest = atof(argv[6]);
    int count = atoi(argv[7]);
    double before = cpu_seconds();
    for (int i = 0; i < count; i++) {
        run.block.p = least + (greatest - least) * i / fmax(count - 1, 1);
        derive(&run.block);
        simulate(&run, &solver, NULL);
    }
    printf("{\"cpu\": %.9g}\n", (cpu_seconds() - before) / count);
    return 0;
}
