"""The house in numbers (house.py): rooms, arrows and contracts stay within what is good for them."""

import pytest

from house import BARS, lazy_links
from modules import whole_house

LAZY = {
    "bodies.elements.strain_slopes_kernels": {
        "bodies.elements.laws.viscous_slopes_kernels": "for solids with a retardation"
    },
    "bodies.rigid.moved_bodies_kernels": {
        "bodies.rigid.tied_rows_kernels": "for bodies that are tied",
        "bodies.rigid.tied_step_kernels": "for bodies that are tied",
    },
    "bodies.rigid.tie_rows_kernels": {
        "bodies.gears.carried_gear_kernels": "for gears in what turns itself",
        "bodies.gears.gear_kernels": "for gears on what stays",
    },
    "compiled.threads_kernels": {"compiled.start_threads_kernels": "where a first term is large enough for threads"},
    "contacts.back_off_kernels": {"contacts.back_off_in_stages_kernels": "for methods whose stages Newton solves"},
    "contacts.body_path_kernels": {"contacts.search_kernels": "when the first body comes near"},
    "contacts.shape_kernels": {"contacts.moving_kernels": "for surfaces that move"},
    "contacts.shapes.implicit_kernels": {"contacts.shapes.nearest_kernels": "when a body has come near the surface"},
    "contacts.rigid_exact.curved_contact_kernels": {
        "contacts.rigid_exact.rim_crossing_kernels": "for rims that touch sharp edges or rims",
    },
    "contacts.rigid_exact.curved_find_kernels": {
        "contacts.rigid_exact.rim_meet_kernels": "for columns beside sharp edges",
    },
    "contacts.rigid_exact.features_kernels": {
        "contacts.rigid_exact.rim_crossing_kernels": "for rims that touch sharp edges, rims or flat ends",
    },
    "field.packets.packet_kernels": {
        "field.packets.enclose_kernels": "for fields that are more than a density",
        "field.packets.inside_kernels": "for solids that one with an exact form is cut by",
        "field.packets.packet_near_kernels": "for bundles of rays at skeletons",
        "field.packets.packet_skeleton_kernels": "for fields with skeletons",
        "field.packets.tape_bundle_kernels": "for bundles of rays at a tape",
    },
    "field.packets.polynomial_search_kernels": {
        "field.packets.polynomial_bundle_kernels": "for bundles of rays at a polynomial",
    },
    "field.roots.density_roots_kernels": {"field.packets.density_bundle_kernels": "for bundles of rays at a density"},
    "field.roots.isolation_kernels": {"field.roots.jumps_kernels": "for fields that jump, or end"},
    "grids.grid_stage_kernels": {
        "grids.embedded_kernels": "for steps that a tolerance chooses",
        "grids.iterate_kernels": "for stages that are not solved to rounding at once",
    },
    "linear.cones.cone_finish_kernels": {
        "linear.cones.cone_kernels": "where Newton's method does not get there from the guess"
    },
    "linear.cones.cone_layout_kernels": {
        "linear.cones.bounded_points_kernels": "where such programs take the interior-point method",
        "linear.cones.bounded_rows_kernels": "for programs with ties, stops, motors or friction",
    },
    "linear.newton_kernels": {"linear.newton_search_kernels": "where plain iterations fail"},
    "march.events_kernels": {"march.locate_kernels": "when the first event is met"},
    "stepping.radau_kernels": {"stepping.radau_tallies_kernels": "when the first tally changes"},
}
"""Strings that close a circle, by the module where they stand: what they name, and when, or for what, it is called."""


@pytest.fixture(scope="module")
def house():
    """All files, read once."""
    return whole_house()


@pytest.mark.parametrize("bar", [bar for bar in BARS if bar.today is None], ids=lambda bar: bar.name)
def test_the_house_stays_within_its_bars(house, bar):
    assert bar.value(house) <= bar.goal


def test_every_string_that_closes_a_circle_is_known(house):
    known = {(f"sceneql.{one}", f"sceneql.{other}") for one, named in LAZY.items() for other in named}
    assert set(lazy_links(house)) == known


def test_words_are_found_by_one_rule(house):
    from sceneql.compiler.catalogue import Catalogue

    catalogue = Catalogue()
    assert {family: set(words) for family, words in house.words.items()} == {
        family: set(catalogue.words(family)) for family in catalogue.families
    }
