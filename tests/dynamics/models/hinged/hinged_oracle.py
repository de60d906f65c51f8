"""The angle of a body on an axle in any precision."""

import mpmath


def angle_of(figures: dict, rate: float, time: float, digits: int = 30) -> mpmath.mpf:
    """Return θ(t) of I θ̈ = N − c θ̇ − k θ + W sin(θ + φ), by Taylor series with so many digits."""
    order = digits + 10
    with mpmath.workdps(digits + 5):
        inertia, torque, loss, stiffness, weight, tilt = (mpmath.mpf(figures[k]) for k in "INckWφ")
        at, end, state = mpmath.mpf(0), mpmath.mpf(time), (mpmath.mpf(0), mpmath.mpf(rate))
        while at < end:
            theta, sine, cosine = [*state], [mpmath.sin(state[0] + tilt)], [mpmath.cos(state[0] + tilt)]
            for n in range(order):
                if n:
                    slopes = [k * theta[k] for k in range(1, n + 1)]
                    sine.append(mpmath.fdot(slopes, cosine[::-1]) / n)
                    cosine.append(-mpmath.fdot(slopes, sine[-2::-1]) / n)
                force = (torque if n == 0 else 0) - loss * (n + 1) * theta[n + 1] - stiffness * theta[n]
                theta.append((force + weight * sine[n]) / (inertia * (n + 1) * (n + 2)))
            last = max(abs(theta[-1]) ** mpmath.mpf(1 / (order + 1)), abs(theta[-2]) ** mpmath.mpf(1 / order))
            step = min(end - at, mpmath.mpf(10) ** (-mpmath.mpf(digits) / order) / last) if last else end - at
            slopes = [k * theta[k] for k in range(1, len(theta))]
            powers = [step**k for k in range(len(theta))]
            state, at = (mpmath.fdot(theta, powers), mpmath.fdot(slopes, powers[:-1])), at + step
        return state[0]
