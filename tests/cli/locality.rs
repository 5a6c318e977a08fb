//! A patched file differs from its input in the records of what the operation moves, and nowhere else: counted line
//! by line, as `diff` does.

use std::collections::BTreeMap;

use super::{Fixture, door_job, support};

/// Entities whose records may change: geometry. The header's `FILE_NAME` carries time and program of a changed file.
const GEOMETRY: [&str; 12] = [
    "FILE_NAME",
    "CARTESIAN_POINT",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "BOUNDED_SURFACE",
    "BOUNDED_CURVE",
    "VECTOR",
    "CIRCLE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "TOROIDAL_SURFACE",
    "SPHERICAL_SURFACE",
];

/// Lines that only one of two texts has, with how often: removed (negative) and added ones.
fn difference<'a>(before: &'a str, after: &'a str) -> BTreeMap<&'a str, i64> {
    let mut counts: BTreeMap<&str, i64> = BTreeMap::new();
    before.lines().for_each(|line| *counts.entry(line).or_default() -= 1);
    after.lines().for_each(|line| *counts.entry(line).or_default() += 1);
    counts.retain(|_, count| *count != 0);
    counts
}

/// Records of one line each, so that a changed line is a changed record.
fn one_record_a_line(text: &str) -> String {
    let joined: String = text.lines().map(str::trim_end).collect();
    joined.replace(';', ";\n")
}

/// Runs a job; gives lines removed and added, after holding that geometry alone changed.
fn changed_lines(input: &str, job: &str, allowed: &[&str]) -> (usize, usize) {
    let fixture = Fixture::new().file("door.step", input).file("job.toml", job);
    let said = fixture.run(&["run", "job.toml"]);
    assert!(said.starts_with("exit code: 0\n"), "{said}");
    let bytes = std::fs::read(fixture.path("out/door.step")).expect("the output");
    let (before, after) = (one_record_a_line(input), one_record_a_line(&String::from_utf8_lossy(&bytes)));
    let differing = difference(&before, &after);
    for line in differing.keys() {
        let entity = line.split_once('=').map_or(*line, |(_, body)| body.trim_start_matches([' ', '(']));
        let entity = entity.split('(').next().unwrap_or_default().trim();
        assert!(allowed.contains(&entity), "{entity} changed: {line}");
    }
    let sum = |sign: i64| -> i64 { differing.values().map(|c| (c * sign).max(0)).sum() };
    let count = |sign| usize::try_from(sum(sign)).expect("a count");
    (count(-1), count(1))
}

/// Records of an entity.
fn records(input: &str, entity: &str) -> usize {
    let start = format!("{entity}(");
    one_record_a_line(input)
        .lines()
        .filter(|l| l.split_once('=').is_some_and(|(_, b)| b.trim().starts_with(&start)))
        .count()
}

#[test]
fn a_plain_scaling_of_the_door_changes_points_and_nothing_else() {
    let input = include_str!("../../samples/door/door.step");
    let (removed, added) = changed_lines(input, &door_job("factors = [1.1, 1.2, 1.25]"), &GEOMETRY);
    // Every record is replaced in place: none comes, none goes.
    assert_eq!(removed, added);
    assert!(removed > 1 && removed <= 1 + records(input, "CARTESIAN_POINT"), "{removed}");
}

#[test]
fn holding_loops_adds_control_points_and_touches_no_attribute() {
    let input = include_str!("../../samples/door/door.step");
    let job = door_job("factors = [1.1, 1.2, 1.25]\nhold = [{ loops = \"inner\" }]");
    // A held circle moves with its placement, which is then written anew.
    let mut allowed = GEOMETRY.to_vec();
    allowed.extend(["AXIS2_PLACEMENT_3D", "DIRECTION", "ELLIPSE"]);
    let (removed, added) = changed_lines(input, &job, &allowed);
    assert!(added > removed, "the refined net has more points: {removed} {added}");
}

#[test]
fn a_real_part_changes_in_its_geometry_only() {
    let Some(corpus) = support::corpus() else { return };
    for part in ["s1-c5-214/FOOT_BACK_000.stp", "issue153.stp", "ubend2.stp"] {
        let bytes = std::fs::read(corpus.join("step").join(part)).expect("a part of the corpus");
        let input = String::from_utf8_lossy(&bytes).into_owned();
        let (removed, added) = changed_lines(&input, &door_job("factors = [0.5, 0.5, 0.5]"), &GEOMETRY);
        // A uniform scaling has a number for each number: a record for each record.
        assert_eq!(removed, added, "{part}");
        let points = records(&input, "CARTESIAN_POINT");
        let others: usize = GEOMETRY[2..].iter().map(|entity| records(&input, entity)).sum();
        assert!(removed > points / 2 && removed <= 1 + points + others, "{part}: {removed} of {points}");
    }
}
