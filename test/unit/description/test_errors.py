"""Issues and what carries them."""
from my_simulations.errors import InputError, Issue, Severity, error, errors_of, warning


def test_an_issue_reads_as_place_severity_message_element_and_hint():
    issue = error("a-code", "it is wrong", file="f.sdf", line=3, column=4, xpath="/sdf", hint="fix")
    assert str(issue) == "f.sdf:3:4: error: it is wrong [/sdf] (fix)"


def test_unknown_places_are_left_out():
    assert str(warning("c", "careful")) == "warning: careful"
    assert Issue(Severity.NOTE, "c", "m", line=3).location == "<text>:3"
    assert Issue(Severity.NOTE, "c", "m", file="f").location == "f"


def test_only_errors_are_errors():
    issues = [warning("w", "w"), error("e", "e")]
    assert [issue.code for issue in errors_of(issues)] == ["e"]


def test_an_input_error_says_its_first_error_and_how_many_more():
    fault = InputError([warning("w", "w"), error("a", "first"), error("b", "second")])
    assert fault.first.code == "a"
    assert str(fault) == "error: first (and 1 more)"
    assert str(InputError([error("a", "only")])) == "error: only"


def test_an_input_error_without_errors_says_what_it_has():
    assert InputError([warning("w", "w")]).first.code == "w"
    assert str(InputError([])) == "unknown error"
