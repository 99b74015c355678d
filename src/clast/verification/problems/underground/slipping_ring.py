"""The ground reaction curve of an opening in a ring of blocks that slip along oblique joints.

All blocks of the ring move alike, each in its own place, and so slip along the joints between them
like the blades of an iris.  So three unknowns of one rigid block are enough: u and v of its
centroid and its rotation, with the next block the same, turned by 2 pi/n.  On every point of a
joint, whose sides part by d_n and slip by d_t,

    s = max(0, s_0 - k_n d_n),    t = t_before - k_s d_t, cut at +-s tan(phi),

and s and t of both joints, those towards the rock around and the pressure p balance.  The equations
are integrated here along the joints and by decrements of p, apart from all of clast.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from clast.contact.contacts import SLIDE
from clast.inputs.builder import ModelBuilder
from clast.model.in_situ import InSituStress
from clast.model.model import Floats, Model, PlaneStrain
from clast.pictures.verification import Chart, curve, exact_curve
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.verification.problem import Comparison, Outcome, Problem, relative
from clast.verification.variants import CONVEX, Variant

INNER, OUTER, AROUND = 3.0, 4.0, 5.0
"""Radii of the opening, of the ring and of the fixed rock around it, m."""
COUNT = 24
"""Blocks of the ring."""
PRESSURE = 1e6
"""Stress in the rock, and pressure in the opening at first, Pa."""
STIFF, STIFF_SHEAR = 1e9, 1e9
"""Stiffness of the joints between the blocks of the ring, Pa/m."""
ROCK = 4e8
"""Stiffness of the joint towards the rock around, along it as well, Pa/m."""
YOUNG = 1e13
"""So stiff that the joints alone give way, Pa."""
STEP, STAGES = 1e-2, 20
"""Step, s, and decrements of the pressure."""
POINTS, DECREMENTS = 400, 200
"""Points of a joint and decrements of the integration."""


@dataclass(frozen=True)
class Ring:
    """A ring whose joints are turned from the radius by an angle that friction may or may not bear."""

    lean: float
    """Angle between the inner and the outer end of a joint, seen from the middle, degrees."""
    friction: float
    """Friction angle of the joints between blocks, degrees."""

    def corners(self, place: int) -> Floats:
        """Return the corners of a block, m, shape (4, 2): inner edge, side, outer edge, side."""
        wide, lean = 2.0 * np.pi / COUNT, np.radians(self.lean)
        angles = wide * (place + np.array([0.5, -0.5, -0.5, 0.5]))
        angles[2:] += lean
        radii = np.array([INNER, INNER, OUTER, OUTER])
        return radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def ring_in_rock(ring: Ring) -> Model:
    """Return the ring under stress, in fixed rock, with a pressure in the opening that fades out."""
    builder = ModelBuilder(title="Slipping ring", plane=PlaneStrain(), gravity=(0.0, 0.0))
    builder.add_rock("rock", young=YOUNG, poisson=0.0, density=2700.0)
    tight = {"cohesion": 1e9, "tensile_strength": 0.0}
    builder.add_joint("default", friction_angle=45.0, normal_stiffness=ROCK, shear_stiffness=ROCK)
    builder.add_joint(
        "iris", friction_angle=ring.friction, normal_stiffness=STIFF, shear_stiffness=STIFF_SHEAR
    )
    builder.add_joint(
        "around", friction_angle=45.0, normal_stiffness=ROCK, shear_stiffness=ROCK, **tight
    )
    builder.in_situ = InSituStress(stress=(-PRESSURE, -PRESSURE, 0.0))
    end = STEP * (1 + STAGES)
    fades = builder.add_table("fades", (0.0, STEP, end), (1.0, 1.0, 0.0))
    for place in range(COUNT):
        corners = ring.corners(place)
        joints = ["default", "iris", "around", "iris"]
        builder.block(name=f"ring {place}", vertices=corners[::-1], edge_joint=joints_of(joints))
        far = corners[[3, 2]] * (AROUND / OUTER)
        outline = np.concatenate([corners[[3, 2]], far[::-1]])
        builder.block(name=f"rock {place}", vertices=outline[::-1], fixed=True, edge_joint=["around"] * 4)
        ends = corners[0], corners[1]
        push = PRESSURE * (middle := 0.5 * (ends[0] + ends[1])) / np.hypot(*middle)
        builder.line_load(tuple(ends[0]), tuple(ends[1]), tuple(push), block=f"ring {place}", factor=fades)
        builder.measured_point(str(place), tuple(corners.mean(axis=0)), block=f"ring {place}")
    return builder.build()


def joints_of(joints):
    """Return the joints of the edges of a block whose corners are given the other way round."""
    # edges of corners[::-1]: 3-2, 2-1, 1-0, 0-3
    return [joints[2], joints[1], joints[0], joints[3]]


def lowered(ring: Ring, variant: Variant) -> Run:
    model = ring_in_rock(ring)
    method = variant.method(model, normal_stiffness=ROCK, max_displacement=0.05, dynamic_ratio=0.0)
    return simulate(model, method, Schedule(step=STEP, end=STEP * (1 + STAGES), every=STEP))


def solution(ring: Ring, decrements: int = DECREMENTS):
    """Return pressures and displacement of centroid (corner mean) radial, slip start."""
    corners = ring.corners(0)
    turn = 2.0 * np.pi / COUNT
    rot = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    centre = corners.mean(axis=0)
    s = (np.arange(POINTS) + 0.5) / POINTS
    def points(a, b):
        return a + s[:, None] * (b - a)
    # the joint to the next block is from corner 0 (inner) to corner 3 (outer)
    face = points(corners[0], corners[3]); lf = np.hypot(*(corners[3]-corners[0])); along=(corners[3]-corners[0])/lf
    normal=np.array([-along[1],along[0]])
    rock = points(corners[2], corners[3]); lr=np.hypot(*(corners[3]-corners[2])); alr=(corners[3]-corners[2])/lr
    outw=np.array([alr[1],-alr[0]])
    inner = 0.5*(corners[0]+corners[1]); li=np.hypot(*(corners[1]-corners[0])); inn=inner/np.hypot(*inner)
    def moved(d, x):
        r = x - centre
        return d[:2] + d[2]*np.stack([-r[:,1], r[:,0]],axis=1)
    before = np.zeros(POINTS)
    last = np.zeros(3)
    back = face @ rot   # R^T x
    tan = np.tan(np.radians(ring.friction))
    def state(d, shear0, dl):
        rel = moved(d, face) - moved(d, back) @ rot.T      # own minus the next one's
        sig = np.maximum(0.0, PRESSURE + STIFF*(rel@normal))
        relold = moved(dl, face) - moved(dl, back) @ rot.T
        trial = shear0 + STIFF_SHEAR*((rel-relold)@along)
        tau = np.clip(trial, -tan*sig, tan*sig)
        return sig, tau, np.abs(trial) > tan*sig
    def cross(r, f): return r[:,0]*f[:,1]-r[:,1]*f[:,0]
    def residual(d, p, shear0, dl):
        sig, tau, _ = state(d, shear0, dl)
        on_face = -(sig[:,None]*normal + tau[:,None]*along)*(lf/POINTS)
        on_back = -(on_face @ rot)                          # R^T of the opposite
        w = moved(d, rock)
        sr = np.maximum(0.0, PRESSURE + ROCK*(w@outw)); tr = ROCK*(w@alr)
        on_rock = -(sr[:,None]*outw + tr[:,None]*alr)*(lr/POINTS)
        push = p*li*inn
        force = on_face.sum(0)+on_back.sum(0)+on_rock.sum(0)+push
        moment = (cross(face-centre,on_face)+cross(back-centre,on_back)+cross(rock-centre,on_rock)).sum() + cross((inner-centre)[None],push[None])[0]
        return np.array([*force, moment])
    out=[]
    for k in range(decrements+1):
        p = PRESSURE*(1-k/decrements)
        d = last.copy()
        for _ in range(60):
            r = residual(d,p,before,last)
            if np.abs(r).max() < 1e-9*PRESSURE: break
            J=np.array([(residual(d+h,p,before,last)-residual(d-h,p,before,last))/(2e-9) for h in 1e-9*np.eye(3)]).T
            d = d - np.linalg.solve(J,r)
        sig,before,slips = state(d,before,last)
        last=d
        rad=centre/np.hypot(*centre); tang=np.array([-rad[1],rad[0]])
        out.append((p, -d[:2]@rad, d[:2]@tang, d[2], slips.mean(), np.abs(r).max()))
    return np.array(out)
