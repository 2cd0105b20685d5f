"""Steady rolls between plates by Fourier and Chebyshev series: the heat that they carry, by no grid of ours."""

import numpy as np


def nusselt(rayleigh, prandtl, wave, modes=8, points=22):
    """Heat through plates 1 apart at 1 and 0, over that of conduction, by rolls of a wavelength; no slip.

    Newton's method on psi = sum S_n(x) p_n(z) and theta = sum C_n(x) t_n(z): p and t at Chebyshev's points in z, sines
    and cosines of n 2 pi x/wave.
    """
    size, number = points + 1, np.arange(modes + 1)
    place = np.arange(size)
    z = 0.5 * (1 + np.cos(np.pi * place / points))
    ends = np.r_[2, np.ones(points - 1), 2] * (-1) ** place
    apart = np.subtract.outer(np.cos(np.pi * place / points), np.cos(np.pi * place / points))
    slope = np.outer(ends, 1 / ends) / (apart + np.eye(size))
    slope = 2 * (slope - np.diag(slope.sum(axis=1)))
    turns = (2 * np.pi / wave * number)[:, None]
    x = np.arange(4 * modes) * wave / (4 * modes)
    cosines, sines = np.cos(turns * x), np.sin(turns * x)

    def wrong(v):
        p = np.vstack([np.zeros(size), v[: modes * size].reshape(modes, size)])
        t = v[modes * size :].reshape(modes + 1, size)
        up = p @ slope.T
        curl = up @ slope.T - turns**2 * p
        u, w = sines.T @ up, -cosines.T @ (turns * p)
        curled = u * (cosines.T @ (turns * curl)) + w * (sines.T @ (curl @ slope.T))
        heated = u * -(sines.T @ (turns * t)) + w * (cosines.T @ (t @ slope.T))
        flow = sines @ curled / (2 * modes) - rayleigh * prandtl * turns * t
        flow -= prandtl * (curl @ slope.T @ slope.T - turns**2 * curl)
        heat = cosines @ heated / (2 * modes) * np.r_[0.5, np.ones(modes)][:, None]
        heat -= t @ slope.T @ slope.T - turns**2 * t
        flow[:, [0, -1]], flow[:, [1, -2]] = p[:, [0, -1]], up[:, [0, -1]]
        heat[:, [0, -1]] = t[:, [0, -1]] - np.outer(number == 0, [0, 1])
        return np.r_[flow[1:].ravel(), heat.ravel()]

    v = np.zeros((2 * modes + 1) * size)
    v[:size] = 6 * np.sin(np.pi * z) ** 2
    v[modes * size :][:size], v[modes * size :][size : 2 * size] = 1 - z, -0.3 * np.sin(np.pi * z)
    for _ in range(20):
        here = wrong(v)
        columns = [(wrong(v + step) - here) / step.max() for step in 1e-6 * np.eye(len(v))]
        change = np.linalg.solve(np.column_stack(columns), -here)
        v = v + change
        if np.linalg.norm(change) < 1e-8 * np.linalg.norm(v):
            break
    return float(-(slope @ v[modes * size :][:size])[-1])
