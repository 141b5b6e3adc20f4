/* A control law that franka_async runs on its real-time thread, without the Python interpreter.
 *
 * A law is a function of this type, which is called with every state of the robot, once a millisecond:
 *
 *     int32_t law(const franka_async_law_cycle *cycle, const double *parameters, double *memory, double *output);
 *
 * It returns FRANKA_ASYNC_LAW_GO_ON, FRANKA_ASYNC_LAW_FINISH (or any positive number) with its last output, after which it
 * is not called any more, or a negative number of its own to have the robot stop; the motion then fails with that number.
 * The robot refuses to end a motion that still moves: finish at rest.
 *
 *   parameters  cycle->parameters_len numbers, which the program may set at any time: all of them change between two cycles.
 *   memory      cycle->memory_len numbers, which are in the next cycle what this cycle left in them. The program may read
 *               them while the law runs.
 *   output      the command, each number NaN before the call; one that is not written or not finite stops the motion:
 *                 torques               7   N m, without gravity and friction: the robot adds both
 *                 joint_positions       7   rad
 *                 joint_velocities      7   rad/s
 *                 cartesian_pose       16   pose of the end effector in the base frame, row by row
 *                 cartesian_velocities  6   twist of the end effector in the base frame, m/s, then rad/s
 *               A law that was made with elbow=True writes two more behind a pose or a twist: position of joint 3, rad, and
 *               sign of joint 4, -1 or 1.
 *
 * It has some 300 us for that, and must not allocate, lock, print, wait, raise a signal or unwind. It may write to memory and
 * output, up to their lengths, and nowhere else. It may be called on different threads, one after the other.
 *
 * SI units, radians. Matrices are row by row, poses with the translation in the last column. Names of the state are the vendor's:
 * O base, F flange, EE end effector, K stiffness frame; X_T_Y is the pose of Y in X.
 */
#ifndef FRANKA_ASYNC_LAW_H
#define FRANKA_ASYNC_LAW_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Incremented when a field changes its place or meaning. Fields that are added at the end change `size` alone. */
#define FRANKA_ASYNC_LAW_VERSION 1

#define FRANKA_ASYNC_LAW_GO_ON 0
#define FRANKA_ASYNC_LAW_FINISH 1

/* The most numbers in parameters and in memory. */
#define FRANKA_ASYNC_LAW_MOST 256

typedef struct franka_async_law_cycle {
    uint32_t version;        /* FRANKA_ASYNC_LAW_VERSION of the driver */
    uint32_t size;           /* of this struct in the driver, bytes */
    uint64_t message_id;     /* the robot's clock, ms */
    double time;             /* since the first cycle of the law, in the robot's time, s */
    double dt;               /* since the state before, s: 0 at first, more than 0.001 after a loss */
    uint64_t parameters_len;
    uint64_t memory_len;

    /* The state. */
    double q[7];                    /* measured joint positions */
    double dq[7];                   /* measured joint velocities */
    double q_d[7];                  /* desired joint positions */
    double dq_d[7];                 /* desired joint velocities */
    double ddq_d[7];                /* desired joint accelerations */
    double tau_J[7];                /* measured link-side torques, gravity included */
    double tau_J_d[7];              /* desired torques, gravity excluded */
    double dtau_J[7];               /* derivative of tau_J */
    double tau_ext_hat_filtered[7]; /* estimated external torques */
    double theta[7];                /* motor positions */
    double dtheta[7];               /* motor velocities */
    double joint_contact[7];        /* 0 or 1 */
    double cartesian_contact[6];    /* 0 or 1 */
    double O_F_ext_hat_K[6];        /* estimated external wrench on the stiffness frame, base axes; positive when the robot pushes */
    double K_F_ext_hat_K[6];        /* the same in the axes of the stiffness frame */
    double O_T_EE[4][4];            /* measured pose of the end effector */
    double O_T_EE_d[4][4];          /* desired pose */
    double O_T_EE_c[4][4];          /* last commanded pose */
    double F_T_EE[4][4];            /* the end effector on the flange */
    double EE_T_K[4][4];            /* the stiffness frame on the end effector */
    double O_dP_EE_d[6];            /* desired twist of the end effector */
    double O_dP_EE_c[6];            /* last commanded twist */
    double elbow[2];                /* measured: position of joint 3, sign of joint 4 */
    double elbow_c[2];              /* last commanded */
    double m_total;                 /* mass of end effector and load */
    double control_command_success_rate; /* of the last 100 commands, 0 to 1 */

    /* Terms of the model for this state, with its end effector and load. */
    double pose[4][4];              /* of the end effector in the base frame */
    double jacobian[6][7];          /* zero Jacobian of the end effector: linear rows first */
    double mass[7][7];              /* joint-space inertia, kg m^2 */
    double coriolis[7];             /* torques of Coriolis and centrifugal forces */
    double gravity[7];              /* torques that hold the arm against gravity; the robot adds them itself */
    double jdot_dq[6];              /* dJ/dt dq */
} franka_async_law_cycle;

typedef int32_t (*franka_async_law)(const franka_async_law_cycle *cycle, const double *parameters, double *memory, double *output);

#ifdef __cplusplus
}
#endif

#endif
