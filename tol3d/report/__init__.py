"""Presentation of a run: tables, pictures, meshes and 3D views, from its summary and from replayed trials.

A page (`page.py`) and a chart (`chart.py`) are data; `sheet.py`, `html/` and `drawn_chart.py` lay them out. Columns of
tables are declared at the fields that they show (`declared.py`). What is a mechanism's own its presenter adds
(`presenter.py`): no mechanism is known here. Names are loaded when they are first used: a table needs no
matplotlib, a picture no trimesh, and
only what shows parts in 3D loads pyvista. Read `page.py` and `table.py` first.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.report.canvas import save_figure
    from tol3d.report.chart_figure import charts_figure, save_charts
    from tol3d.report.check import check_report
    from tol3d.report.compare import comparison_report
    from tol3d.report.comparison_picture import draw_comparison
    from tol3d.report.declared import (
        declared_table,
        side_by_side,
    )
    from tol3d.report.export import (
        export_run,
        part_meshes,
    )
    from tol3d.report.histogram import draw_histogram
    from tol3d.report.html.blocks import page_html
    from tol3d.report.html.document import report_html
    from tol3d.report.html.view_model import ViewModel
    from tol3d.report.measure_charts import spanned
    from tol3d.report.measure_table import CONVERTED_ROWS
    from tol3d.report.motion import travels_of
    from tol3d.report.number import (
        NOTHING,
        given_text,
        short_text,
        tip_mm,
        value_text,
    )
    from tol3d.report.presenter import display_build
    from tol3d.report.published import STATISTICS
    from tol3d.report.table import run_report
    from tol3d.report.view import view_run

_HOMES = {
    "CONVERTED_ROWS": "tol3d.report.measure_table",
    "NOTHING": "tol3d.report.number",
    "STATISTICS": "tol3d.report.published",
    "ViewModel": "tol3d.report.html.view_model",
    "charts_figure": "tol3d.report.chart_figure",
    "check_report": "tol3d.report.check",
    "comparison_report": "tol3d.report.compare",
    "declared_table": "tol3d.report.declared",
    "display_build": "tol3d.report.presenter",
    "draw_comparison": "tol3d.report.comparison_picture",
    "draw_histogram": "tol3d.report.histogram",
    "export_run": "tol3d.report.export",
    "given_text": "tol3d.report.number",
    "page_html": "tol3d.report.html.blocks",
    "part_meshes": "tol3d.report.export",
    "report_html": "tol3d.report.html.document",
    "run_report": "tol3d.report.table",
    "save_charts": "tol3d.report.chart_figure",
    "save_figure": "tol3d.report.canvas",
    "short_text": "tol3d.report.number",
    "side_by_side": "tol3d.report.declared",
    "spanned": "tol3d.report.measure_charts",
    "tip_mm": "tol3d.report.number",
    "travels_of": "tol3d.report.motion",
    "value_text": "tol3d.report.number",
    "view_run": "tol3d.report.view",
}

__all__ = [
    "CONVERTED_ROWS",
    "NOTHING",
    "STATISTICS",
    "ViewModel",
    "charts_figure",
    "check_report",
    "comparison_report",
    "declared_table",
    "display_build",
    "draw_comparison",
    "draw_histogram",
    "export_run",
    "given_text",
    "page_html",
    "part_meshes",
    "report_html",
    "run_report",
    "save_charts",
    "save_figure",
    "short_text",
    "side_by_side",
    "spanned",
    "tip_mm",
    "travels_of",
    "value_text",
    "view_run",
]

__getattr__, __dir__ = lazy_names(__name__, _HOMES)
