/*
 * The block in space of docs/unit/model.md with SUNDIALS CVODE: variable-order Adams (fixed point) or BDF (Newton), events by CVodeRootInit
 * with directions, stops at the kinks of the excitation, a restart after each event.
 *
 *     cvode_space CASE adams|bdf TOLERANCE END SECONDS
 *
 * CASE is a text file of numbers by `compare.py`. Runs to END (s), again for SECONDS of CPU time, and prints the state at the end, the
 * least CPU time of a run (s), evaluations, steps and events.
 */
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <time.h>

enum { MAX_FEET = 64, BODY = 13, PER_FOOT = 2 };
enum contact { STICKS, SLIDES, LIFTED };

struct block {
    double mass, g, inertia[9], inverse[9], k, c, kh, ch, mu, r0, alpha, p, omega_v;
    int n;
    double foot[MAX_FEET][3], free_height[MAX_FEET];
    /* One sine along each axis: amplitude, circular frequency, start. */
    double sine[3][3];
    /* Records along x and y from t = 0 on, with a time step. */
    int samples;
    double dt, *record[2];
    double start[BODY];
};

struct run {
    struct block b;
    enum contact contact[MAX_FEET];
    double depth[MAX_FEET], since[MAX_FEET];
    /* Excitation between two stops: waves that act, and the lines of the records. */
    bool acts[3];
    double line[2][2], line_start;
    long rhs, steps, events;
};

static void fail(const char *what, double number)
{
    fprintf(stderr, "%s (%g)\n", what, number);
    exit(1);
}

static void read_case(const char *path, struct block *b)
{
    FILE *file = fopen(path, "r");
    if (!file)
        fail("the case cannot be read", 0.0);
    double head[14 + 9 + 9 + 9];
    for (size_t i = 0; i < sizeof head / sizeof *head; i++)
        if (fscanf(file, "%lf", &head[i]) != 1)
            fail("the case is too short", (double)i);
    double *h = head;
    b->n = (int)*h++, b->mass = *h++, b->g = *h++, b->k = *h++, b->c = *h++, b->kh = *h++, b->ch = *h++, b->mu = *h++;
    b->r0 = *h++, b->alpha = *h++, b->p = *h++, b->omega_v = *h++, b->samples = (int)*h++, b->dt = *h++;
    memcpy(b->inertia, h, sizeof b->inertia);
    memcpy(b->inverse, h + 9, sizeof b->inverse);
    memcpy(b->sine, h + 18, sizeof b->sine);
    for (int i = 0; i < BODY; i++)
        if (fscanf(file, "%lf", &b->start[i]) != 1)
            fail("the case lacks its start", i);
    for (int i = 0; i < b->n; i++)
        if (fscanf(file, "%lf %lf %lf %lf", &b->foot[i][0], &b->foot[i][1], &b->foot[i][2], &b->free_height[i]) != 4)
            fail("the case lacks a foot", i);
    for (int axis = 0; axis < 2; axis++) {
        b->record[axis] = malloc(sizeof(double) * (size_t)(b->samples + 1));
        for (int i = 0; i < b->samples; i++)
            if (fscanf(file, "%lf", &b->record[axis][i]) != 1)
                fail("the case lacks a sample", i);
    }
    fclose(file);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}

static void times(const double m[9], const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

/* The rotation of a quaternion of any length: R v = v + change. */
static void turn(const double q[4], double sign, const double v[3], double out[3])
{
    double factor = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), one[3], two[3];
    cross(q + 1, v, one);
    cross(q + 1, one, two);
    for (int i = 0; i < 3; i++)
        out[i] = (sign * q[0] * one[i] + two[i]) * factor;
}

struct foot_motion {
    double arm[3], displacement[3], velocity[3];
};

static struct foot_motion motion_of(const double *y, const double place[3])
{
    struct foot_motion m;
    double change[3], spin[3];
    turn(y + 3, 1.0, place, change);
    for (int i = 0; i < 3; i++)
        m.arm[i] = place[i] + change[i], m.displacement[i] = y[i] + change[i];
    cross(y + 10, m.arm, spin);
    for (int i = 0; i < 3; i++)
        m.velocity[i] = y[7 + i] + spin[i];
    return m;
}

static double normal_of(const struct block *b, int i, const struct foot_motion *m)
{
    return b->k * (b->free_height[i] - m->displacement[2]) - b->c * m->velocity[2];
}

static void trial_of(const struct block *b, const double *e, const struct foot_motion *m, double trial[2])
{
    trial[0] = b->kh * e[0] + b->ch * m->velocity[0], trial[1] = b->kh * e[1] + b->ch * m->velocity[1];
}

static int right_hand_side(sunrealtype t, N_Vector state, N_Vector rates, void *data)
{
    struct run *run = data;
    const struct block *b = &run->b;
    const double *y = N_VGetArrayPointer(state);
    double *d = N_VGetArrayPointer(rates);
    double force[3] = {0}, moment[3] = {0}, ground[3] = {0};
    for (int axis = 0; axis < 3; axis++)
        if (run->acts[axis])
            ground[axis] = b->sine[axis][0] * sin(b->sine[axis][1] * (t - b->sine[axis][2]));
    for (int axis = 0; axis < 2; axis++)
        ground[axis] += run->line[axis][0] + run->line[axis][1] * (t - run->line_start);
    for (int i = 0; i < b->n; i++) {
        double *de = d + BODY + PER_FOOT * i;
        const double *e = y + BODY + PER_FOOT * i;
        de[0] = de[1] = 0.0;
        if (run->contact[i] == LIFTED)
            continue;
        struct foot_motion m = motion_of(y, b->foot[i]);
        double trial[2], normal = normal_of(b, i, &m);
        trial_of(b, e, &m, trial);
        de[0] = m.velocity[0], de[1] = m.velocity[1];
        double f[3] = {-trial[0], -trial[1], normal};
        if (run->contact[i] == SLIDES) {
            double size = sqrt(trial[0] * trial[0] + trial[1] * trial[1]), slip = (size - b->mu * normal) / b->ch;
            for (int axis = 0; axis < 2; axis++) {
                double along = size > 0.0 ? trial[axis] / size : 0.0;
                f[axis] = -b->mu * normal * along;
                de[axis] -= along * slip;
            }
        }
        double arm[3];
        cross(m.arm, f, arm);
        for (int axis = 0; axis < 3; axis++)
            force[axis] += f[axis], moment[axis] += arm[axis];
    }
    double body[3], back[3], spin[3], torque[3], product[3], turned[3], change[3];
    turn(y + 3, -1.0, y + 10, change);
    for (int i = 0; i < 3; i++)
        body[i] = y[10 + i] + change[i];
    turn(y + 3, -1.0, moment, change);
    for (int i = 0; i < 3; i++)
        torque[i] = moment[i] + change[i];
    times(b->inertia, body, product);
    cross(body, product, spin);
    for (int i = 0; i < 3; i++)
        torque[i] -= spin[i];
    times(b->inverse, torque, back);
    turn(y + 3, 1.0, back, turned);
    const double *q = y + 3, *w = y + 10;
    for (int i = 0; i < 3; i++) {
        d[i] = y[7 + i];
        d[7 + i] = force[i] / b->mass - ground[i] - (i == 2 ? b->g : 0.0);
        d[10 + i] = back[i] + turned[i];
    }
    d[3] = -0.5 * (w[0] * q[1] + w[1] * q[2] + w[2] * q[3]);
    cross(w, q + 1, spin);
    for (int i = 0; i < 3; i++)
        d[4 + i] = 0.5 * (w[i] * q[0] + spin[i]);
    return 0;
}

/* Two functions a foot, which fall through zero at events: N and μ N − |F|, |F| − μ N, or the gap twice. */
static int roots(sunrealtype t, N_Vector state, sunrealtype *out, void *data)
{
    struct run *run = data;
    const struct block *b = &run->b;
    const double *y = N_VGetArrayPointer(state);
    for (int i = 0; i < b->n; i++) {
        struct foot_motion m = motion_of(y, b->foot[i]);
        if (run->contact[i] == LIFTED) {
            double sunk = run->depth[i] * exp(-(t - run->since[i]) * b->k / b->c);
            out[2 * i] = m.displacement[2] - (b->free_height[i] - sunk);
            out[2 * i + 1] = 1.0;
            continue;
        }
        double trial[2], normal = normal_of(b, i, &m);
        trial_of(b, y + BODY + PER_FOOT * i, &m, trial);
        double room = b->mu * normal - sqrt(trial[0] * trial[0] + trial[1] * trial[1]);
        out[2 * i] = normal;
        out[2 * i + 1] = run->contact[i] == STICKS ? room : -room;
    }
    return 0;
}

/* Applies the events of the functions with signs. */
static void pass_events(struct run *run, double t, double *y, const int *signs)
{
    const struct block *b = &run->b;
    for (int i = 0; i < b->n; i++) {
        double *e = y + BODY + PER_FOOT * i;
        struct foot_motion m = motion_of(y, b->foot[i]);
        if (signs[2 * i] && run->contact[i] == LIFTED) {
            double trial[2], normal = -b->c * m.velocity[2] + b->k * (b->free_height[i] - m.displacement[2]);
            if (normal <= 0.0)
                continue;
            e[0] = e[1] = 0.0;
            trial_of(b, e, &m, trial);
            bool slides = sqrt(trial[0] * trial[0] + trial[1] * trial[1]) > b->mu * normal;
            run->contact[i] = slides ? SLIDES : STICKS;
            run->events += slides;
        } else if (signs[2 * i]) {
            run->contact[i] = LIFTED;
            run->depth[i] = b->free_height[i] - m.displacement[2];
            run->since[i] = t;
            e[0] = e[1] = 0.0;
        } else if (signs[2 * i + 1]) {
            run->contact[i] = run->contact[i] == STICKS ? SLIDES : STICKS;
        } else {
            continue;
        }
        run->events++;
    }
}

/* Sets the excitation from `t` on, and returns the time to which it is smooth. */
static double next_piece(struct run *run, double t)
{
    const struct block *b = &run->b;
    double stop = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double from = b->sine[axis][2], until = from + 2.0 * M_PI / b->sine[axis][1];
        bool is_wave = b->sine[axis][0] != 0.0;
        run->acts[axis] = is_wave && t >= from && t < until;
        if (is_wave && from > t)
            stop = fmin(stop, from);
        if (run->acts[axis])
            stop = fmin(stop, until);
    }
    memset(run->line, 0, sizeof run->line);
    if (b->samples > 1) {
        int i = (int)(t / b->dt + 0.5);
        if (i < b->samples - 1) {
            run->line_start = i * b->dt;
            for (int axis = 0; axis < 2; axis++) {
                const double *a = b->record[axis];
                run->line[axis][0] = a[i], run->line[axis][1] = (a[i + 1] - a[i]) / b->dt;
            }
            stop = fmin(stop, (i + 1) * b->dt);
        }
    }
    return stop;
}

struct solver {
    void *memory;
    N_Vector y;
    bool newton, restarts;
};

static struct solver make_solver(struct run *run, const char *method, double tolerance)
{
    const struct block *b = &run->b;
    int n = BODY + PER_FOOT * b->n;
    SUNContext context;
    SUNContext_Create(NULL, &context);
    /* With `-through` steps pass over the kinks of records, with their history. */
    struct solver s = {.newton = strncmp(method, "bdf", 3) == 0, .restarts = strstr(method, "-through") == NULL};
    s.y = N_VNew_Serial(n, context);
    N_Vector weights = N_VNew_Serial(n, context);
    double *w = N_VGetArrayPointer(weights), rocking = b->alpha * b->p;
    for (int i = 0; i < n; i++) {
        /* A displacement counts as the velocity that the supports would give it. */
        double scale = i < 3 ? b->r0 * rocking / b->omega_v : i < 7 ? b->alpha : i < 10 ? b->r0 * rocking : rocking;
        w[i] = tolerance * (i < BODY ? scale : b->r0 * rocking / b->omega_v);
    }
    s.memory = CVodeCreate(s.newton ? CV_BDF : CV_ADAMS, context);
    int directions[2 * MAX_FEET];
    for (int i = 0; i < 2 * b->n; i++)
        directions[i] = -1;
    bool ok = CVodeInit(s.memory, right_hand_side, 0.0, s.y) == CV_SUCCESS
        && CVodeSVtolerances(s.memory, tolerance, weights) == CV_SUCCESS && CVodeSetUserData(s.memory, run) == CV_SUCCESS
        && CVodeRootInit(s.memory, 2 * b->n, roots) == CV_SUCCESS && CVodeSetRootDirection(s.memory, directions) == CV_SUCCESS
        && CVodeSetNoInactiveRootWarn(s.memory) == CV_SUCCESS && CVodeSetMaxNumSteps(s.memory, 10000000) == CV_SUCCESS;
    if (s.newton) {
        SUNMatrix matrix = SUNDenseMatrix(n, n, context);
        ok = ok && CVodeSetLinearSolver(s.memory, SUNLinSol_Dense(s.y, matrix, context), matrix) == CV_SUCCESS;
    } else {
        ok = ok && CVodeSetNonlinearSolver(s.memory, SUNNonlinSol_FixedPoint(s.y, 0, context)) == CV_SUCCESS;
    }
    if (!ok)
        fail("CVODE does not start", 0.0);
    return s;
}

static void take_counts(struct run *run, const struct solver *s)
{
    long rhs = 0, linear = 0, steps = 0;
    CVodeGetNumRhsEvals(s->memory, &rhs);
    CVodeGetNumSteps(s->memory, &steps);
    if (s->newton)
        CVodeGetNumLinRhsEvals(s->memory, &linear);
    run->rhs += rhs + linear;
    run->steps += steps;
}

static void simulate(struct run *run, const struct solver *s, double end)
{
    const struct block *b = &run->b;
    double *y = N_VGetArrayPointer(s->y), t = 0.0;
    memset(y, 0, sizeof(double) * (size_t)(BODY + PER_FOOT * b->n));
    memcpy(y, b->start, sizeof b->start);
    run->rhs = run->steps = run->events = 0;
    for (int i = 0; i < b->n; i++) {
        struct foot_motion m = motion_of(y, b->foot[i]);
        bool touches = m.displacement[2] < b->free_height[i] && normal_of(b, i, &m) > 0.0;
        double trial[2], zero[2] = {0};
        trial_of(b, zero, &m, trial);
        bool slides = hypot(trial[0], trial[1]) > b->mu * normal_of(b, i, &m);
        run->contact[i] = touches ? (slides ? SLIDES : STICKS) : LIFTED;
        run->depth[i] = b->free_height[i] - fmin(b->free_height[i], m.displacement[2]);
        run->since[i] = 0.0;
    }
    double stop = fmin(next_piece(run, t), end);
    CVodeReInit(s->memory, t, s->y);
    CVodeSetStopTime(s->memory, stop);
    while (t < end) {
        /* To a time after the stop, as otherwise CVODE would not report the stop. */
        int flag = CVode(s->memory, stop + 1.0, s->y, &t, CV_NORMAL);
        if (flag < 0)
            fail("CVODE stopped with", flag);
        bool again = false;
        if (flag == CV_ROOT_RETURN) {
            int signs[2 * MAX_FEET];
            CVodeGetRootInfo(s->memory, signs);
            pass_events(run, t, y, signs);
            again = true;
        } else if (flag == CV_TSTOP_RETURN && t < end) {
            t = stop;
            stop = fmin(next_piece(run, t), end);
            again = s->restarts;
            CVodeSetStopTime(s->memory, stop);
        }
        if (again) {
            take_counts(run, s);
            CVodeReInit(s->memory, t, s->y);
            CVodeSetStopTime(s->memory, stop);
        }
    }
    take_counts(run, s);
}

static double cpu_time(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv)
{
    static struct run run;
    if (argc < 6)
        fail("usage: cvode_space CASE adams|bdf[-through] TOLERANCE END SECONDS", argc);
    read_case(argv[1], &run.b);
    struct solver solver = make_solver(&run, argv[2], atof(argv[3]));
    double end = atof(argv[4]), least = INFINITY, begin = cpu_time();
    do {
        double before = cpu_time();
        simulate(&run, &solver, end);
        least = fmin(least, cpu_time() - before);
    } while (cpu_time() - begin < atof(argv[5]));
    for (int i = 0; i < BODY; i++)
        printf("%.17g ", N_VGetArrayPointer(solver.y)[i]);
    printf("%.9g %ld %ld %ld\n", least, run.rhs, run.steps, run.events);
    return 0;
}
