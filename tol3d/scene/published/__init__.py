"""Published figures: any number of a run's summary, by the summary's own keys, methods left out."""

from tol3d.scene.published.measure import PublishedColumn, PublishedMeasure
from tol3d.scene.published.whole import PublishedFigures

__all__ = ["PublishedColumn", "PublishedFigures", "PublishedMeasure"]
