"""Presentation of a run: tables, pictures, meshes and 3D views, from its summary and from replayed trials.

Names are loaded when they are first used: a table needs no matplotlib, a picture no trimesh, and only
`tol3d.report.view` loads pyvista.
"""

from typing import TYPE_CHECKING

from tol3d.import_path import lazy_names

if TYPE_CHECKING:
    from tol3d.report.check import check_report
    from tol3d.report.compare import comparison_report
    from tol3d.report.comparison_picture import draw_comparison
    from tol3d.report.export import export_run, part_meshes
    from tol3d.report.histogram import draw_histogram
    from tol3d.report.html.blocks import page_html
    from tol3d.report.html.document import report_html
    from tol3d.report.table import run_report
    from tol3d.report.view import view_run

_HOMES = {
    "check_report": "tol3d.report.check",
    "comparison_report": "tol3d.report.compare",
    "draw_comparison": "tol3d.report.comparison_picture",
    "draw_histogram": "tol3d.report.histogram",
    "export_run": "tol3d.report.export",
    "page_html": "tol3d.report.html.blocks",
    "part_meshes": "tol3d.report.export",
    "report_html": "tol3d.report.html.document",
    "run_report": "tol3d.report.table",
    "view_run": "tol3d.report.view",
}

__all__ = [
    "check_report",
    "comparison_report",
    "draw_comparison",
    "draw_histogram",
    "export_run",
    "page_html",
    "part_meshes",
    "report_html",
    "run_report",
    "view_run",
]

__getattr__ = lazy_names(__name__, _HOMES)
