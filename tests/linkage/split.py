"""A linkage whose bodies are placed by several moves, one loop after the other."""

from collections.abc import Sequence

from linkage.linked_bodies import Linkage


def split(linkage: Linkage, groups: Sequence[Sequence[str]], deviating: Sequence[str] | None = None) -> str:
    """The scene of a linkage, its bodies in groups; a joint belongs to the first group that has both its ends.

    Inputs and poses are those of the first group; those after it stand as it makes them.
    """
    done, lines, left = set(linkage.fixed), list[str](), dict(linkage.joints)
    for k, bodies in enumerate(groups):
        done |= set(bodies)
        own = {name: each for name, each in left.items() if {each.on.split(".")[0], each.of.split(".")[0]} <= done}
        left = {name: each for name, each in left.items() if name not in own}
        inputs = {name: each for name, each in linkage.inputs.items() if each[0] in own}
        lines += linkage.loop_lines(f"drive {k}", bodies, own, inputs, linkage.poses if k == 0 else {})
    assert not left
    head, _, tail = linkage.text(deviating).partition("  drive:\n")
    return head + "\n".join(lines) + "\n" + tail[tail.index("measures:") :]
