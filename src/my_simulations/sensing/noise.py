"""Noise of sensors, drawn by counting: sample n is the same whether or not sample n - 1 was taken."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    pass

GAUSSIAN, QUANTIZED = "gaussian", "gaussian_quantized"


@dataclass(frozen=True)
class NoiseSpec:
    """SDF `<noise>`; `type` none, gaussian or gaussian_quantized; in the unit of what is measured."""

    type: str = "none"
    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0
    dynamic_bias_stddev: float = 0.0
    dynamic_bias_correlation_time: float = 0.0
    precision: float = 0.0
