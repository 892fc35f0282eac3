/*
 * The block of docs/unit/model.md for solvers in C and C++: equations of motion, surfaces, impacts, and the case file.
 *
 *   SOLVER CASE METHOD TOLERANCE time SECONDS    repeats the run for this CPU time; one line of JSON
 *   SOLVER CASE METHOD TOLERANCE trace           the rotation at multiples of the case's dt; one line of JSON
 *
 * METHOD is followed for records by the action at a sample: -restart (stop and restart), -stop (stop, and continue with the
 * history) or -through (none).
 *
 * State: theta, theta_dot, v, v_dot, and on the rigid base theta, theta_dot. Forces are per mass.
 */
#pragma once
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LEFT, RIGHT };

/* +1 on L, -1 on R: the rotation that lowers the corner's height over its sine is s theta. */
static const double SIGN[2] = {1.0, -1.0};

struct block {
    double alpha, p, eta, xi_v, epsilon, gamma, gravity, rigid;
    double shape, a_p, omega_p;
    double settled, theta, theta_dot;
    double t_end, dt;
    double record_dt, record_samples;
    double *record;
    /* Derived values; lengths in m, K and C per mass. */
    double r0, i0, b, h, omega_v, k, c, delta_s, restitution;
};

enum at_samples { RESTART, STOP, THROUGH };

struct run {
    struct block block;
    void (*equations)(const struct run *, double t, const double *y, double *rate);
    bool touching[2];
    /* Creep of the supports that nothing touches: delta_s - y at the time `since`. */
    double depth[2], since[2];
    /* Rigid base: which way it tilts, 0 at rest. */
    double tilt;
    /* The ground acceleration a0 + slope (t - t0) of the present piece, and the pulse while it acts. */
    double a0, slope, t0;
    bool pulse, follows_record;
    /* Counters. */
    long rhs, steps;
    int events;
};

static void fail(const char *what, double value)
{
    printf("{\"error\": \"%s (%g)\"}\n", what, value);
    exit(1);
}

static double ground(const struct run *run, double t)
{
    const struct block *b = &run->block;
    if (run->pulse)
        return b->shape == 1.0 ? b->a_p * sin(b->omega_p * t) : b->a_p * cos(b->omega_p * t);
    if (run->follows_record) {
        double x = t / b->record_dt;
        int i = (int)x;
        int last = (int)b->record_samples - 1;
        return i >= last ? 0.0 : b->record[i] + (x - i) * (b->record[i + 1] - b->record[i]);
    }
    return run->a0 + run->slope * (t - run->t0);
}

/* R0 sin phi and R0 cos phi with phi = alpha + s theta: the corner's distances from the centre of mass. */
struct arms {
    double reach, height;
};

static inline struct arms arms(const struct block *b, double s, double sin_theta, double cos_theta)
{
    struct arms a = {b->b * cos_theta + s * b->h * sin_theta, b->h * cos_theta - s * b->b * sin_theta};
    return a;
}

static inline double reaction(const struct block *b, double height, double rate)
{
    return b->k * (b->delta_s - height) - b->c * rate;
}

/* Eqs. (7)-(10). */
static void full_contact(const struct run *run, double t, const double *y, double *rate)
{
    const struct block *b = &run->block;
    double sin_theta = sin(y[0]), cos_theta = cos(y[0]);
    struct arms l = arms(b, 1.0, sin_theta, cos_theta), r = arms(b, -1.0, sin_theta, cos_theta);
    double n_l = reaction(b, y[2] + b->h - l.height, y[3] + l.reach * y[1]);
    double n_r = reaction(b, y[2] + b->h - r.height, y[3] - r.reach * y[1]);
    double arm = b->h * cos_theta;
    rate[0] = y[1];
    rate[1] = (-arm * (ground(run, t) - b->h * sin_theta * y[1] * y[1]) + n_l * l.reach - n_r * r.reach)
        / (b->i0 + arm * arm);
    rate[2] = y[3];
    rate[3] = n_l + n_r - b->gravity;
}

/* Eqs. (11)-(13). */
static inline void on_corner(const struct run *run, double s, double t, const double *y, double *rate)
{
    const struct block *b = &run->block;
    double sin_theta = sin(y[0]), cos_theta = cos(y[0]);
    struct arms a = arms(b, s, sin_theta, cos_theta);
    double n = reaction(b, y[2] + b->h - a.height, y[3] + s * a.reach * y[1]);
    rate[0] = y[1];
    rate[1] = (-a.height * (ground(run, t) - s * a.reach * y[1] * y[1]) + s * n * a.reach)
        / (b->i0 + a.height * a.height);
    rate[2] = y[3];
    rate[3] = n - b->gravity;
}

static void on_left(const struct run *run, double t, const double *y, double *rate)
{
    on_corner(run, 1.0, t, y, rate);
}

static void on_right(const struct run *run, double t, const double *y, double *rate)
{
    on_corner(run, -1.0, t, y, rate);
}

/* Housner's block. */
static void on_rigid_base(const struct run *run, double t, const double *y, double *rate)
{
    const struct block *b = &run->block;
    double phi = run->tilt * b->alpha - y[0];
    rate[0] = y[1];
    rate[1] = -b->p * b->p * (sin(phi) + cos(phi) * ground(run, t) / b->gravity);
}

static double corner_height(const struct block *b, int i, const double *y)
{
    return y[2] + b->h - arms(b, SIGN[i], sin(y[0]), cos(y[0])).height;
}

static double corner_rate(const struct block *b, int i, const double *y)
{
    return y[3] + SIGN[i] * arms(b, SIGN[i], sin(y[0]), cos(y[0])).reach * y[1];
}

static double support_top(const struct run *run, int i, double t)
{
    const struct block *b = &run->block;
    if (run->depth[i] == 0.0)
        return b->delta_s;
    return b->delta_s - run->depth[i] * exp(-(t - run->since[i]) * b->k / b->c);
}

/* The functions whose fall through zero ends the regime: reactions of touching corners, gaps of the others; returns their number. */
static int surfaces(const struct run *run, double t, const double *y, double *out)
{
    const struct block *b = &run->block;
    if (b->rigid != 0.0) {
        out[0] = run->tilt * y[0];
        return 1;
    }
    double sin_theta = sin(y[0]), cos_theta = cos(y[0]);
    for (int i = LEFT; i <= RIGHT; i++) {
        struct arms a = arms(b, SIGN[i], sin_theta, cos_theta);
        double height = y[2] + b->h - a.height;
        out[i] = run->touching[i] ? reaction(b, height, y[3] + SIGN[i] * a.reach * y[1])
                                  : height - support_top(run, i, t);
    }
    return 2;
}

static void choose_equations(struct run *run)
{
    if (run->block.rigid != 0.0)
        run->equations = on_rigid_base;
    else
        run->equations = !run->touching[RIGHT] ? on_left : !run->touching[LEFT] ? on_right : full_contact;
}

static void lift(struct run *run, int i, double t, const double *y)
{
    run->touching[i] = false;
    run->depth[i] = run->block.delta_s - corner_height(&run->block, i, y);
    run->since[i] = t;
}

/* Releases corners whose supports would have to pull, now or in the next moment. */
static void settle(struct run *run, double t, const double *y)
{
    const struct block *b = &run->block;
    const double rounding = 1e-12 * b->gravity;
    for (bool again = true; again;) {
        again = false;
        choose_equations(run);
        double rate[4];
        run->equations(run, t, y, rate);
        for (int i = LEFT; i <= RIGHT && !again; i++) {
            if (!run->touching[i])
                continue;
            struct arms a = arms(b, SIGN[i], sin(y[0]), cos(y[0]));
            double v = corner_rate(b, i, y);
            double n = reaction(b, corner_height(b, i, y), v);
            double acceleration = rate[3] + SIGN[i] * a.reach * rate[1] + a.height * y[1] * y[1];
            if (n < -rounding || (n <= rounding && -b->k * v - b->c * acceleration < 0.0)) {
                lift(run, i, t, y);
                again = true;
            }
        }
        if (!run->touching[LEFT] && !run->touching[RIGHT])
            fail("complete separation", t);
    }
}

/* Eqs. (14)-(19) and, for R, their mirror image. */
static void land(struct run *run, int i, double *y)
{
    const struct block *b = &run->block;
    run->touching[i] = true;
    if (corner_rate(b, i, y) >= 0.0)
        return;
    double s = SIGN[i], e = b->epsilon;
    double sin_theta = sin(y[0]), cos_theta = cos(y[0]);
    struct arms here = arms(b, s, sin_theta, cos_theta), there = arms(b, -s, sin_theta, cos_theta);
    double a = b->h * cos_theta * here.height, bb = here.reach * here.reach, pp = there.height * here.height;
    double d = b->i0 + a + bb;
    double v = y[3], w = y[1];
    y[3] = ((e * (b->i0 + a) + bb) * v + s * ((e - 1.0) * b->i0 + e * a - pp) * here.reach * w) / d;
    y[1] = (s * (e - 1.0) * here.reach * v + (b->i0 + e * bb + pp) * w) / d;
}

/* Lengths, stiffness and damping from the dimensionless numbers. */
static void derive(struct block *b)
{
    b->r0 = b->gamma / (1.0 + b->gamma) * b->gravity / (b->p * b->p);
    b->i0 = b->r0 * b->r0 / b->gamma;
    b->b = b->r0 * sin(b->alpha);
    b->h = b->r0 * cos(b->alpha);
    b->omega_v = b->eta * b->p;
    b->k = 0.5 * b->omega_v * b->omega_v;
    b->c = b->xi_v * b->omega_v;
    b->delta_s = b->gravity / (b->omega_v * b->omega_v);
    b->restitution =
        (1.0 + b->gamma * b->epsilon + (1.0 - b->epsilon) * b->gamma * cos(2.0 * b->alpha)) / (1.0 + b->gamma);
}

static void read_case(const char *path, struct block *b)
{
    memset(b, 0, sizeof *b);
    struct {
        const char *name;
        double *place;
    } names[] = {
        {"alpha", &b->alpha}, {"p", &b->p}, {"eta", &b->eta}, {"xi_v", &b->xi_v}, {"epsilon", &b->epsilon},
        {"gamma", &b->gamma}, {"gravity", &b->gravity}, {"rigid", &b->rigid}, {"shape", &b->shape},
        {"a_p", &b->a_p}, {"omega_p", &b->omega_p}, {"settled", &b->settled}, {"theta", &b->theta},
        {"theta_dot", &b->theta_dot}, {"t_end", &b->t_end}, {"dt", &b->dt}, {"record_dt", &b->record_dt},
        {"record_samples", &b->record_samples},
    };
    FILE *file = fopen(path, "r");
    if (!file)
        fail("no case file", 0.0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[32];
        double value;
        if (fscanf(file, "%31s %lf", name, &value) != 2 || strcmp(name, names[i].name) != 0)
            fail("the case file is not as expected in line", (double)(i + 1));
        *names[i].place = value;
    }
    b->record = (double *)malloc(((size_t)b->record_samples + 1) * sizeof *b->record);
    for (int i = 0; i < (int)b->record_samples; i++)
        if (fscanf(file, "%lf", &b->record[i]) != 1)
            fail("the record is too short", i);
    fclose(file);
    derive(b);
}

/* State and regime at t = 0, or on the rigid base when rocking starts; returns the time. */
static double start(struct run *run, double *y)
{
    const struct block *b = &run->block;
    run->rhs = run->steps = run->events = 0;
    run->a0 = run->slope = run->t0 = 0.0;
    run->pulse = b->shape != 0.0;
    if (b->rigid != 0.0) {
        double t = asin(b->gravity * tan(b->alpha) / b->a_p) / b->omega_p;
        run->tilt = -1.0;
        y[0] = y[1] = 0.0;
        choose_equations(run);
        return t;
    }
    double turn = b->b * sin(b->theta);
    double middle = b->settled != 0.0 ? fmax(fabs(turn) - b->delta_s, 0.0) : 0.0;
    y[0] = b->theta;
    y[1] = b->theta_dot;
    y[2] = b->settled != 0.0 ? middle - b->h * (1.0 - cos(b->theta)) : 0.0;
    y[3] = 0.0;
    for (int i = LEFT; i <= RIGHT; i++) {
        run->touching[i] = corner_height(b, i, y) <= b->delta_s;
        run->depth[i] = run->since[i] = 0.0;
    }
    settle(run, 0.0, y);
    return 0.0;
}

/* Applies the events of the surfaces that the motion has fallen through; returns whether the motion is another one now. */
static bool pass_events(struct run *run, const bool *found, double t, double *y)
{
    if (++run->events > 10000)
        fail("events without end at", t);
    if (run->block.rigid != 0.0) {
        if (run->tilt * y[1] >= 0.0)
            return false;
        y[0] = 0.0;
        y[1] *= run->block.restitution;
        run->tilt = -run->tilt;
        return true;
    }
    for (int i = LEFT; i <= RIGHT; i++) {
        if (found[i] && run->touching[i])
            lift(run, i, t, y);
        else if (found[i])
            land(run, i, y);
    }
    settle(run, t, y);
    return true;
}

static enum at_samples at_samples_of(const char *method)
{
    return strstr(method, "-through") ? THROUGH : strstr(method, "-stop") ? STOP : RESTART;
}

/* Sets the excitation from `t` on; returns the next kink at which to stop. */
static double next_piece(struct run *run, enum at_samples at_samples, double t, int *sample)
{
    const struct block *b = &run->block;
    if (b->shape != 0.0) {
        double end = 2.0 * M_PI / b->omega_p;
        run->pulse = t < end;
        return run->pulse && end < b->t_end ? end : b->t_end;
    }
    int last = (int)b->record_samples - 1;
    if (last < 1)
        return b->t_end;
    run->follows_record = at_samples == THROUGH;
    if (at_samples == THROUGH)
        return fmin(last * b->record_dt, b->t_end);
    int i = *sample;
    if (i >= last) {
        run->a0 = run->slope = 0.0;
        return b->t_end;
    }
    run->t0 = i * b->record_dt;
    run->a0 = b->record[i];
    run->slope = (b->record[i + 1] - b->record[i]) / b->record_dt;
    return fmin((i + 1) * b->record_dt, b->t_end);
}

/* Rows of a trace. */
static int rows_of(const struct block *b)
{
    return (int)floor(b->t_end / b->dt + 0.5) + 1;
}

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Traces a run or repeats it for a time, as the command line asks; `simulate` makes one run with this solver. */
static int answer(int argc, char **argv, struct run *run, void *solver, void (*simulate)(struct run *, void *, double *trace))
{
    if (strcmp(argv[4], "trace") == 0) {
        int rows = rows_of(&run->block);
        double *trace = (double *)calloc((size_t)rows, sizeof *trace);
        simulate(run, solver, trace);
        printf("{\"theta\": [%.17g", trace[0]);
        for (int i = 1; i < rows; i++)
            printf(", %.17g", trace[i]);
        printf("]}\n");
        free(trace);
        return 0;
    }
    double seconds = argc > 5 ? atof(argv[5]) : 0.0;
    simulate(run, solver, NULL);
    long repeats = 0;
    double before = cpu_seconds(), used;
    do {
        simulate(run, solver, NULL);
        repeats++;
        used = cpu_seconds() - before;
    } while (used < seconds);
    printf("{\"cpu\": %.9g, \"rhs\": %ld, \"steps\": %ld, \"events\": %d}\n", used / (double)repeats, run->rhs,
           run->steps, run->events);
    return 0;
}
