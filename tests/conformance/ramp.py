"""The slope of a ramp from samples of it."""


def slope(samples, low, high):
    """Least-squares slope of the samples with low <= value <= high. samples: (time, value)."""
    inside = [(t, v) for t, v in samples if low <= v <= high]
    assert len(inside) >= 8, f"only {len(inside)} samples between {low} and {high}: {samples}"
    mean_t = sum(t for t, _ in inside) / len(inside)
    mean_v = sum(v for _, v in inside) / len(inside)
    return sum((t - mean_t) * (v - mean_v) for t, v in inside) / sum((t - mean_t) ** 2 for t, _ in inside)
