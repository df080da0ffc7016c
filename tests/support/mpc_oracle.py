"""The optimal control problem of the paper (eq:J_MPC, eq:inpCon, eq:stateCon), written down anew from the linear model.

Of the MPC it has the settings alone, no matrix: a wrong weight, sign, stage or bound there shows as another move. It is
solved as a least-distance problem by non-negative least squares (Lawson and Hanson, chapter 23).
"""

import numpy as np
from scipy.linalg import block_diag, solve_discrete_are
from scipy.optimize import nnls
from scipy.signal import cont2discrete


def weights_of_error(weights, layout):
    """Q of the deviations, by what they are a penalty of."""
    N = layout.number_of_uavs
    Q = np.zeros((layout.size, layout.size))

    def penalise(rows, weight):
        nonlocal Q
        Q = Q + rows.T @ (np.reshape(weight, (-1, 1)) * rows)

    identity = np.eye(layout.size)
    penalise(identity[layout.r_0], weights.position)
    penalise(identity[layout.v_0], weights.velocity)
    penalise(identity[layout.Theta], weights.attitude)
    penalise(identity[layout.omega], weights.rates)
    for part, each, apart in (
        (layout.s, weights.link_tilt, weights.differential_link_tilt),
        (layout.s_dot, weights.link_rate, weights.differential_link_rate),
    ):
        rows = identity[part]
        mean = np.tile(rows.reshape(N, 2, -1).mean(axis=0), (N, 1))
        penalise(rows, each)
        penalise(rows - mean, apart)
    penalise(identity[layout.n], weights.uav_tilt)
    penalise(identity[layout.n_dot], weights.uav_tilt_rate)
    penalise(identity[layout.f], weights.thrust)
    return Q


def state_limits(model, settings, height):
    """Rows, bounds and number of the slack of each soft limit on the error of a team that is to hover at ``height``."""
    p, layout = model.parameters, model.layout
    rows, bounds, slacks = [], [], []

    def limit(row, bound, slack):
        rows.append(row)
        bounds.append(bound)
        slacks.append(slack)

    identity = np.eye(layout.size)
    for axis, row in enumerate(identity[layout.Theta]):
        limit(row, np.radians(settings.tuning.payload_tilt_limit_deg), axis)
        limit(-row, np.radians(settings.tuning.payload_tilt_limit_deg), axis)
    limit(identity[2], height - p.payload.below, 3)  # down
    # UAV i is at r_0 + Theta x p_i - l_i s_i.
    uavs = []
    for i in range(p.number_of_uavs):
        rotated = np.cross(identity[layout.Theta].T, p.p[i]).T
        link = np.vstack([identity[layout.s][2 * i : 2 * i + 2], np.zeros(layout.size)])
        uavs.append(identity[layout.r_0] + rotated - p.l[i] * link)
    hover = p.p - p.l[:, None] * np.array([0.0, 0.0, 1.0])
    for i in range(len(hover)):
        for j in range(i):
            apart = hover[i] - hover[j]
            distance = np.linalg.norm(apart)
            if distance < settings.neighbour_share * p.spacing + 1e-9:
                closer = -(apart / distance) @ (uavs[i] - uavs[j])
                limit(closer, max(distance - p.separation(settings.separation_share), 0.0), 4)
    return np.array(rows), np.array(bounds), np.array(slacks)


def optimal_moves(model, settings, blocks, error, height):
    """All moves (blocks, 3 N) of the optimum about hover at ``height`` (m)."""
    p, layout = model.parameters, model.layout
    n, m, moves = layout.size, layout.inputs, len(blocks)
    A, B, *_ = cont2discrete((model.A, model.B, np.eye(n), np.zeros((n, m))), settings.period)
    weights = settings.tuning.weights
    Q = weights_of_error(weights, layout)
    R = np.diag(np.repeat([weights.tilt_setpoint, weights.thrust_setpoint], [2 * m // 3, m // 3]))
    last = solve_discrete_are(A, B, Q, R)
    rows, bounds, slack_of_row = state_limits(model, settings, height)
    number = slack_of_row.max() + 1

    # Over the decision (moves, slacks): the error is free + steered @ moves, stage by stage.
    free, steered = error, np.zeros((n, moves * m))
    P, g = np.zeros((moves * m, moves * m)), np.zeros(moves * m)
    G, h = [], []
    stage = 0
    for move, held in enumerate(blocks):
        own = np.zeros((m, moves * m))
        own[:, move * m : (move + 1) * m] = np.eye(m)
        for _ in range(held):
            P += own.T @ R @ own
            free, steered = A @ free, A @ steered + B @ own
            stage += 1
            weight = last if stage == sum(blocks) else Q
            P += steered.T @ weight @ steered
            g += steered.T @ weight @ free
            if (stage - 1) % settings.constraint_interval == 0:
                G.append(np.hstack([rows @ steered, -np.eye(number)[slack_of_row]]))
                h.append(bounds - rows @ free)
        tilt = np.full(2 * m // 3, np.tan(np.radians(settings.tuning.uav_tilt_limit_deg)))
        most = np.concatenate([tilt, settings.thrust_share_max * p.thrust_max - p.hover_thrust])
        least = np.concatenate([-tilt, settings.least_lift * p.m * p.g - p.hover_thrust])
        G += [np.hstack([own, np.zeros((m, number))]), np.hstack([-own, np.zeros((m, number))])]
        h += [most, -least]
    G.append(np.hstack([np.zeros((number, moves * m)), -np.eye(number)]))
    h.append(np.zeros(number))
    P = block_diag(P, settings.slack_quadratic * np.eye(number))
    g = np.append(g, np.full(number, settings.slack_linear))
    return least_distance(P, g, np.vstack(G), np.concatenate(h))[: moves * m].reshape(moves, m)


def least_distance(P, g, G, h):
    """Minimiser of x'Px / 2 + g'x in G x <= h."""
    L = np.linalg.cholesky((P + P.T) / 2)
    shift = np.linalg.solve(L, g)  # y = L'x + shift: the nearest point to zero in A y >= b
    A = -np.linalg.solve(L, G.T).T
    b = -h + A @ shift
    scale = np.linalg.norm(np.column_stack([A, b]), axis=1)
    E = np.vstack([A.T, b]) / scale
    f = np.append(np.zeros(len(P)), 1.0)
    u, _ = nnls(E, f, maxiter=20 * len(h))
    r = E @ u - f
    return np.linalg.solve(L.T, -r[:-1] / r[-1] - shift)
