"""The laws of wheels, rolling, sliding, landing and standing again, in worlds in use."""
from __future__ import annotations

from dataclasses import dataclass, replace
from inspect import signature
from typing import Callable, Dict, Iterator, List, Optional

import pytest
import test_contact
import test_elastic_bounces
import test_gripping
import test_landing
import test_mesh_floors
import test_pushed_boxes
import test_rolling
import test_settling
import test_skid
import test_sliding
import test_slip
import test_standing
import test_structures
import test_surfaces
import test_wheels
from laws import Laws
from under_use import USES, Use, UsedLaws, used


@dataclass(frozen=True)
class Case:
    """A law of another file, with the arguments for one run.

    Attributes:
        law: the test.
        arguments: its arguments beside `lab` and `laws`.
        sunk: its bodies may start in the ground.
        longest: the longest time of one wait, s: laws of rest wait for a minute.
        largest_step: the largest step, s, at which it holds (doc/dev/contacts.md has the others).
        calm: without wind, under which lying cylinders and arms with brakes creep.
    """

    law: Callable[..., None]
    arguments: Dict[str, object]
    sunk: bool = False
    longest: Optional[float] = None
    largest_step: float = 0.01
    calm: bool = False

    def __str__(self) -> str:
        return "-".join([self.law.__name__[5:], *map(str, self.arguments.values())])


def _case(law: Callable[..., None], sunk: bool = False, longest: Optional[float] = None,
          largest_step: float = 0.01, calm: bool = False, **arguments: object) -> Case:
    return Case(law, arguments, sunk, longest, largest_step, calm)


CASES: List[Case] = [
    _case(test_skid.test_a_skid_steered_base_turns_at_every_heading, True, heading=15),
    _case(test_skid.test_a_skid_steered_base_turns_on_a_box, True),
    _case(test_skid.test_a_base_on_wide_wheels_turns_in_place, True, rate=1.0, crooked=8e-4),
    _case(test_skid.test_a_base_that_skids_comes_to_rest_and_stays, longest=2.0),
    _case(test_skid.test_sliding_wheels_tell_their_friction, True),
    _case(test_skid.test_a_base_on_wide_wheels_turns_as_its_edges_share_its_weight, True,
          com=-0.07, crooked=8e-4, largest_step=0.002),
    _case(test_rolling.test_a_lying_can_stays_where_it_is, True, longest=2.0, floor="plane",
          asleep=False, seconds=2, largest_step=0.002),
    _case(test_rolling.test_a_lying_can_stays_where_it_is, True, longest=2.0, floor="mesh",
          asleep=True, seconds=2, calm=True, largest_step=0.001),
    _case(test_rolling.test_a_cylinder_rolls_on_at_its_speed, True, floor="plane", speed=0.5,
          seconds=2, largest_step=0.001),
    _case(test_rolling.test_a_cylinder_rolls_on_at_its_speed, True, floor="box", speed=3.0,
          seconds=2, largest_step=0.001),
    _case(test_rolling.test_a_rod_that_is_put_down_comes_to_rest_on_the_floor, floor="plane",
          kind="cylinder", above=0.02, calm=True, largest_step=0.002),
    _case(test_rolling.test_a_rod_that_is_put_down_comes_to_rest_on_the_floor, floor="box",
          kind="capsule", above=0.001, calm=True, largest_step=0.002),
    _case(test_rolling.test_a_rod_rolls_on_at_its_speed, longest=1.0, kind="cylinder",
          speed=2.0, largest_step=0.005),
    _case(test_rolling.test_a_rod_rolls_on_at_its_speed, longest=1.0, kind="capsule",
          speed=0.05, largest_step=0.002),
    _case(test_rolling.test_hinged_wheels_roll_on_at_their_speed, True, kind="one", floor="plane",
          speed=0.5, seconds=2),
    _case(test_rolling.test_hinged_wheels_roll_on_at_their_speed, True, kind="car", floor="box",
          speed=0.5, seconds=2),
    _case(test_rolling.test_hinged_wheels_roll_over_the_seams_of_a_height_map, kind="car",
          speed=0.5, seconds=2, largest_step=0.002),
    _case(test_rolling.test_a_cylinder_rolls_down_a_slope),
    _case(test_wheels.test_wheels_under_equal_efforts_go_straight, True, floor="plane", radius=0.1,
          width=0.1, turned=False),
    _case(test_wheels.test_wide_wheels_stand_on_both_edges, True),
    _case(test_wheels.test_a_base_on_two_wheels_keeps_its_heading_as_it_starts_and_stops, True,
          floor="plane", roll=-1.57, mu=1.0, period=10),
    _case(test_pushed_boxes.test_a_base_that_pushes_a_box_keeps_its_heading, mass=0.3, mu=0.5,
          speed=0.2, step=None, bar=0.5, heading=0.5),
    _case(test_sliding.test_a_box_slides_as_far_in_every_direction, True, size=test_sliding.FLAT,
          floor="box"),
    _case(test_sliding.test_a_box_that_lands_flat_does_not_tilt, height=0.5, largest_step=0.001),
    _case(test_sliding.test_a_box_that_lands_flat_does_not_tilt, height=4.996, largest_step=0.001),
    _case(test_sliding.test_an_upright_cylinder_slides_on_a_floor_not_in_it, True, speed=1.0,
          mu=0.0, largest_step=0.001),
    _case(test_sliding.test_an_upright_cylinder_slides_on_a_floor_not_in_it, True, speed=1.0,
          mu=0.3, largest_step=0.002),
    _case(test_sliding.test_upright_cylinders_slide_and_wheels_roll_on_triangles_in_one_world,
          speed=0.3, largest_step=0.002),
    _case(test_sliding.test_an_upright_cylinder_slides_over_the_seams_of_level_boxes,
          speed=0.7071, start=-1.4563, largest_step=0.002),
    _case(test_sliding.test_an_upright_cylinder_stops_at_a_step),
    _case(test_landing.test_what_is_dropped_upright_lands_upright, floor="plane", name="can",
          largest_step=0.001),
    _case(test_landing.test_what_is_dropped_upright_lands_upright, floor="box", name="hexagon",
          largest_step=0.001),
    _case(test_landing.test_what_has_wheels_or_legs_lands_level, height=0.5),
    _case(test_landing.test_what_lands_almost_flat_does_as_a_box_does, degrees=0.2),
    _case(test_landing.test_a_landing_on_a_corner_gives_no_energy, name="can", largest_step=0.002),
    _case(test_landing.test_a_can_bounces_as_high_as_its_restitution_says_and_stays_upright),
    _case(test_landing.test_five_cans_on_each_other_stand, True, longest=2.0),
    _case(test_landing.test_a_can_stands_on_a_disc_that_turns),
    _case(test_landing.test_what_falls_on_what_fell_beside_it_lands_upright),
    _case(test_standing.test_twenty_boxes_on_each_other_stand, True, longest=2.0, seconds=2),
    _case(test_standing.test_heavy_boxes_stand_on_light_ones, True, longest=2.0,
          masses=(1, 100, 1000), largest_step=0.002),
    _case(test_standing.test_twenty_cards_lie_on_each_other, True, longest=2.0, largest_step=0.005),
    _case(test_standing.test_a_mesh_rests_at_its_height, longest=2.0, floor="plane"),
    _case(test_standing.test_a_mesh_of_several_pieces_rests_at_its_height, floor="plane"),
    _case(test_structures.test_an_arch_stands, True, longest=2.0, seconds=2),
    _case(test_structures.test_dominoes_fall_one_after_the_other, longest=3.0, largest_step=0.005),
    _case(test_settling.test_a_parked_robot_stays_where_it_is, True, longest=2.0, floor="plane",
          brake=0.0, seconds=2, bar=0.01),
    _case(test_settling.test_a_robot_with_braked_wheels_stays_on_a_slope, longest=2.0, degrees=20,
          seconds=2, bar=0.01),
    # 0.003 mm without others in the world.
    _case(test_settling.test_an_arm_with_brakes_stays_where_it_is, longest=2.0, seconds=2, bar=0.03,
          base="standing", calm=True, largest_step=0.002),
    _case(test_settling.test_boxes_stay_on_a_ramp_of_20_degrees, longest=2.0, sleeps=False),
    _case(test_settling.test_mesh_objects_stay_on_the_boards_of_a_shelf, longest=2.0,
          overlap=0.002, sleeps=True, largest_step=0.002),
    _case(test_settling.test_a_can_with_the_inertia_of_a_ship_does_not_roll_out_of_an_overlap,
          longest=2.0),
    _case(test_contact.test_pairs_have_the_smaller_friction_all_in_one_world, True, kind="rigid"),
    _case(test_contact.test_pairs_have_the_smaller_friction_all_in_one_world, True,
          kind="articulated"),
    _case(test_contact.test_a_foot_of_a_body_joined_to_the_world_has_the_smaller_friction),
    _case(test_contact.test_a_tower_of_slippery_boxes_still_stands, True, longest=2.0),
    _case(test_contact.test_a_box_slides_beyond_the_angle_of_friction, mu=0.5),
    _case(test_contact.test_a_bounce_rises_to_e_squared_of_the_height_from_any_height, e=0.8,
          height=1.0, kind="rigid"),
    _case(test_contact.test_a_body_spawned_in_the_ground_settles_without_leaving_it, longest=2.0,
          kind="rigid"),
    _case(test_contact.test_a_table_on_four_legs_does_not_creep, True, longest=2.0),
    _case(test_elastic_bounces.test_bounces_rise_to_the_square_of_the_restitution, step=None),
    _case(test_mesh_floors.test_what_slides_over_a_level_mesh_keeps_its_speed, speed=0.7071),
    _case(test_mesh_floors.test_things_rest_on_a_flat_mesh_at_its_height, angle=0.3),
    _case(test_gripping.test_a_grip_holds, longest=2.0, grip=10.0, seconds=2),
    _case(test_slip.test_what_is_pulled_slips_by_its_slip_times_the_force, longest=2.0, slip=0.02,
          jointed=False),
    _case(test_surfaces.test_friction_has_two_coefficients_about_the_first_direction, True, mu=0.5,
          mu2=0.2, kind="articulated"),
    _case(test_surfaces.test_each_collision_of_a_link_has_its_own_friction, True, front=0.2,
          back=0.6, jointed=True, self_collide=False),
    _case(test_surfaces.test_a_soft_contact_gives_way_by_force_over_kp, kp=1e4, kind="rigid"),
]


def _runs() -> Iterator[object]:
    """The first case of each law at one of its two largest steps; all others are long runs.

    Small steps take longest, and most laws run at 1 ms in their own file.
    """
    known = set()
    for n, case in enumerate(CASES):
        uses = [use for use in USES if use.step_size <= case.largest_step]
        first = case.law not in known
        known.add(case.law)
        for m, use in enumerate(uses):
            usual = first and m == len(uses) - 1 - n % min(2, len(uses))
            yield pytest.param(case, replace(use, wind=not case.calm), id=f"{case}-{use}",
                               marks=() if usual else pytest.mark.long)


@pytest.mark.parametrize("case, use", _runs())
def test_a_law_holds_in_a_world_in_use(laws: Laws, case: Case, use: Use):
    arguments = dict(case.arguments)
    if "step" in arguments:
        arguments["step"] = use.step_size
    with used(use, case.sunk, case.longest) as lab:
        if "laws" in signature(case.law).parameters:
            arguments["laws"] = UsedLaws(laws, use)
        case.law(lab, **arguments)
