"""The cones of a bevel gear's solid, with circles, straight lines and their traces in step with their parameters.

Every surface is laid so that u = pi in the middle of what it bears: no face meets a seam, and no parameter is ever
taken round by a whole turn.
"""

import math
from dataclasses import dataclass
from typing import Final, Literal

from OCP.Geom import Geom_Circle, Geom_ConicalSurface, Geom_Curve, Geom_Line, Geom_Surface
from OCP.Geom2d import Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d

from tol3d.gears import BevelGear

FRONT_RIM, BACK_RIM = 0.5, 2.0  # modules of blank below the root along the front and back cones, where there is room
RIM_SHARE = 0.4  # of the way from the root to bore or axis that a rim may take

End = Literal["toe", "heel"]
TOE: Final = "toe"
HEEL: Final = "heel"
ENDS: tuple[End, End] = (TOE, HEEL)


@dataclass(frozen=True)
class EndCone:
    """Front or back cone: upright on the pitch line at a distance from the apex; v [mm] runs outwards from there."""

    gear: BevelGear
    end: End

    @property
    def distance(self) -> float:
        """Distance of the pitch line's end from the apex [mm]."""
        return self.gear.inner_cone_distance if self.end == TOE else self.gear.outer_cone_distance

    def v_at(self, polar: float) -> float:
        """Place where the cone of that polar angle cuts this one."""
        return self.distance * math.tan(polar - self.gear.pitch_angle)

    def reach(self, polar: float) -> float:
        """Distance [mm] from the apex there."""
        return self.distance / math.cos(polar - self.gear.pitch_angle)

    def radius(self, v: float) -> float:
        """Distance from the axis [mm]."""
        return self.distance * math.sin(self.gear.pitch_angle) + v * math.cos(self.gear.pitch_angle)

    def height(self, v: float) -> float:
        """z [mm]."""
        return self.distance * math.cos(self.gear.pitch_angle) - v * math.sin(self.gear.pitch_angle)

    @property
    def rim(self) -> float:
        """v where the blank's flat face begins."""
        gear, root = self.gear, self.v_at(self.gear.root_angle)
        wanted = (FRONT_RIM if self.end == TOE else BACK_RIM) * gear.module * self.distance / gear.outer_cone_distance
        room = (self.radius(root) - gear.bore / 2) / math.cos(gear.pitch_angle)
        return root - min(wanted, RIM_SHARE * room)

    def point(self, v: float, azimuth: float) -> gp_Pnt:
        """A point of the cone."""
        radius = self.radius(v)
        return gp_Pnt(radius * math.cos(azimuth), radius * math.sin(azimuth), self.height(v))

    def frame(self, azimuth: float) -> gp_Ax2:
        """For cone and circles around that azimuth, which gets u = pi; u falls as azimuths grow."""
        return gp_Ax2(gp_Pnt(0.0, 0.0, self.height(0.0)), gp_Dir(0.0, 0.0, -1.0), across(azimuth + math.pi))

    def surface(self, azimuth: float) -> Geom_Surface:
        """Its normal points away from the apex."""
        lean = math.pi / 2 - self.gear.pitch_angle
        return Geom_ConicalSurface(gp_Ax3(self.frame(azimuth)), lean, self.radius(0.0))

    def circle(self, v: float, azimuth: float) -> Geom_Curve:
        """Its parameter is the cone's u."""
        frame = self.frame(azimuth)
        frame.SetLocation(gp_Pnt(0.0, 0.0, self.height(v)))
        return Geom_Circle(frame, self.radius(v))

    def generator(self, azimuth: float) -> Geom_Curve:
        """Its parameter is the cone's v."""
        lean = self.gear.pitch_angle
        along = gp_Dir(math.cos(lean) * math.cos(azimuth), math.cos(lean) * math.sin(azimuth), -math.sin(lean))
        return Geom_Line(self.point(0.0, azimuth), along)


def across(azimuth: float) -> gp_Dir:
    """Straight away from the axis."""
    return gp_Dir(math.cos(azimuth), math.sin(azimuth), 0.0)


def apex_cone(polar: float, azimuth: float) -> Geom_Surface:
    """Tip or root cone: u is pi at that azimuth and grows with it, v is the distance from the apex."""
    frame = gp_Ax3(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0), across(azimuth + math.pi))
    return Geom_ConicalSurface(frame, polar, 0.0)


def ray(polar: float, azimuth: float) -> Geom_Curve:
    """A line from the apex; its parameter is the distance from there."""
    outwards, sin = across(azimuth), math.sin(polar)
    return Geom_Line(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(sin * outwards.X(), sin * outwards.Y(), math.cos(polar)))


def level(v: float) -> Geom2d_Curve:
    """The circle at v, in step with u."""
    return Geom2d_Line(gp_Pnt2d(0.0, v), gp_Dir2d(1.0, 0.0))


def falling(from_u: float, v: float) -> Geom2d_Curve:
    """The circle at v, against u."""
    return Geom2d_Line(gp_Pnt2d(from_u, v), gp_Dir2d(-1.0, 0.0))


def upright(u: float) -> Geom2d_Curve:
    """The straight line at u, in step with v."""
    return Geom2d_Line(gp_Pnt2d(u, 0.0), gp_Dir2d(0.0, 1.0))
