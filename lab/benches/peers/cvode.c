/*
 * Solves the block of block.h with SUNDIALS CVODE, as an engineer would: variable-order Adams or BDF, events by
 * CVodeRootInit with directions, stops at the kinks of the excitation, a restart after each event.
 *
 * METHOD is adams-fixed, adams-newton or bdf-newton.
 */
#include "block.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

static int right_hand_side(sunrealtype t, N_Vector y, N_Vector rate, void *data)
{
    const struct run *run = data;
    run->equations(run, t, N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
    return 0;
}

static int roots(sunrealtype t, N_Vector y, sunrealtype *out, void *data)
{
    surfaces((const struct run *)data, t, N_VGetArrayPointer(y), out);
    return 0;
}

struct solver {
    void *memory;
    N_Vector y, weights;
    SUNContext context;
    enum at_samples at_samples;
    bool newton;
};

static struct solver make_solver(struct run *run, const char *method, double tolerance)
{
    struct solver s = {0};
    const struct block *b = &run->block;
    bool rigid = b->rigid != 0.0;
    int n = rigid ? 2 : 4;
    bool bdf = strncmp(method, "bdf", 3) == 0, newton = strstr(method, "newton") != NULL;
    s.at_samples = at_samples_of(method);
    s.newton = newton;
    SUNContext_Create(NULL, &s.context);
    s.y = N_VNew_Serial(n, s.context);
    s.weights = N_VNew_Serial(n, s.context);
    double *w = N_VGetArrayPointer(s.weights);
    w[0] = tolerance * b->alpha;
    w[1] = tolerance * b->alpha * b->p;
    if (!rigid) {
        /* A height counts as the velocity that the supports would give it. */
        w[3] = tolerance * b->r0 * b->alpha * b->p;
        w[2] = w[3] / b->omega_v;
    }
    s.memory = CVodeCreate(bdf ? CV_BDF : CV_ADAMS, s.context);
    choose_equations(run);
    bool ok = CVodeInit(s.memory, right_hand_side, 0.0, s.y) == CV_SUCCESS
        && CVodeSVtolerances(s.memory, tolerance, s.weights) == CV_SUCCESS
        && CVodeSetUserData(s.memory, run) == CV_SUCCESS
        && CVodeRootInit(s.memory, rigid ? 1 : 2, roots) == CV_SUCCESS
        && CVodeSetRootDirection(s.memory, (int[]){-1, -1}) == CV_SUCCESS
        && CVodeSetNoInactiveRootWarn(s.memory) == CV_SUCCESS
        && CVodeSetMaxNumSteps(s.memory, 10000000) == CV_SUCCESS;
    if (newton) {
        SUNMatrix matrix = SUNDenseMatrix(n, n, s.context);
        ok = ok && CVodeSetLinearSolver(s.memory, SUNLinSol_Dense(s.y, matrix, s.context), matrix) == CV_SUCCESS;
    } else {
        ok = ok && CVodeSetNonlinearSolver(s.memory, SUNNonlinSol_FixedPoint(s.y, 0, s.context)) == CV_SUCCESS;
    }
    if (!ok)
        fail("CVODE does not start", 0.0);
    return s;
}

/* Adds the solver's counts since its last start. */
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

/* One run; with `trace`, the rotation at multiples of dt. */
static void simulate(struct run *run, void *solver, double *trace)
{
    const struct solver *s = (const struct solver *)solver;
    const struct block *b = &run->block;
    const int rows = rows_of(b);
    double *y = N_VGetArrayPointer(s->y);
    int sample = 0, row = 0;
    double t = start(run, y);
    while (trace && row < rows && row * b->dt <= t)
        trace[row++] = y[0];
    double stop = next_piece(run, s->at_samples, t, &sample);
    CVodeReInit(s->memory, t, s->y);
    CVodeSetStopTime(s->memory, stop);
    N_Vector inside = trace ? N_VClone(s->y) : NULL;
    while (t < b->t_end) {
        /* To a time after the stop, as otherwise CVODE would not report the stop. */
        int flag = CVode(s->memory, stop + 1.0, s->y, &t, trace ? CV_ONE_STEP : CV_NORMAL);
        if (flag < 0)
            fail("CVODE stopped with", flag);
        while (trace && row < rows && row * b->dt <= t + 1e-12) {
            CVodeGetDky(s->memory, fmin(row * b->dt, t), 0, inside);
            trace[row++] = N_VGetArrayPointer(inside)[0];
        }
        bool again = false;
        if (flag == CV_ROOT_RETURN) {
            int signs[2] = {0, 0};
            CVodeGetRootInfo(s->memory, signs);
            again = pass_events(run, (bool[]){signs[0] != 0, signs[1] != 0}, t, y);
        } else if (flag == CV_TSTOP_RETURN && t < b->t_end) {
            t = stop;
            sample++;
            again = s->at_samples == RESTART;
            stop = next_piece(run, s->at_samples, t, &sample);
            CVodeSetStopTime(s->memory, stop);
        }
        if (again) {
            take_counts(run, s);
            CVodeReInit(s->memory, t, s->y);
            CVodeSetStopTime(s->memory, stop);
        }
    }
    take_counts(run, s);
    if (inside)
        N_VDestroy(inside);
}

int main(int argc, char **argv)
{
    static struct run run;
    if (argc < 5)
        fail("usage: cvode CASE METHOD TOLERANCE time SECONDS | trace", argc);
    read_case(argv[1], &run.block);
    struct solver solver = make_solver(&run, argv[2], atof(argv[3]));
    return answer(argc, argv, &run, &solver, simulate);
}
