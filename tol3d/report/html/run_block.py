"""A run as a notebook shows it: which one it is, its verdict, and how its trials ended."""

from tol3d.report.html.blocks import page_blocks
from tol3d.report.html.tags import tag, together
from tol3d.report.table import Detail, run_report, status_line
from tol3d.runs.run import Run


def run_html(run: Run) -> str:
    """A finished run."""
    found = run.found
    words = f"{run.trials} trials · seed {found.seed} · engine {found.engine} · {run.path}"
    blocks = [*run_report(found, Detail.VERDICT).blocks, status_line(found)]
    return str(together(tag("p", tag("b", found.scene), f" · {words}"), page_blocks(blocks)))
