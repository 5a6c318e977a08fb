//! Which loops share a motion, and the refinement that may join more of them.

use std::collections::{BTreeMap, BTreeSet};

use super::ScaleError;
use super::envelope::Prepared;
use super::refine::{Refined, refine};
use super::scaling::Scaling;
use super::task::FaceTask;

/// Which loops move together: for each face and loop the index of its group's first loop.
#[derive(Debug, Clone)]
pub(super) struct Grouping {
    /// By face and loop.
    pub(super) root: Vec<Vec<usize>>,
    /// By face and loop: the caller's number of its group.
    number: Vec<Vec<usize>>,
    /// Loops joined because they are near.
    pub(super) merged: Vec<usize>,
    /// Roots that were given up, with the root that took their place.
    joined: BTreeMap<usize, usize>,
}

impl Grouping {
    /// As the tasks say.
    pub(super) fn new(tasks: &[FaceTask<'_>]) -> Self {
        let mut first = BTreeMap::new();
        let mut count = 0;
        let root = tasks.iter().map(|task| {
            let roots = task.held.iter().map(|l| {
                let root = *first.entry(l.group).or_insert(count);
                count += 1;
                root
            });
            roots.collect()
        });
        let number = tasks.iter().map(|task| task.held.iter().map(|l| l.group).collect());
        Self { root: root.collect(), number: number.collect(), merged: Vec::new(), joined: BTreeMap::new() }
    }

    /// Joins the groups that loops with these roots are in by now; roots may have been joined already.
    fn join_roots(&mut self, a: usize, b: usize) {
        let (a, b) = (self.current(a), self.current(b));
        if a == b {
            return;
        }
        let (keep, drop) = (a.min(b), a.max(b));
        self.joined.insert(drop, keep);
        for root in self.root.iter_mut().flatten() {
            if *root == drop {
                *root = keep;
            }
        }
        self.merged.retain(|&m| m != drop);
        self.merged.push(keep);
    }

    fn current(&self, mut root: usize) -> usize {
        while let Some(&kept) = self.joined.get(&root) {
            root = kept;
        }
        root
    }

    /// For each root in order the caller's numbers of the groups that move with it.
    pub(super) fn sets(&self) -> Vec<Vec<usize>> {
        let of = |root: usize| {
            let loops = self.root.iter().flatten().zip(self.number.iter().flatten());
            let numbers: BTreeSet<usize> = loops.filter(|(r, _)| **r == root).map(|(_, n)| *n).collect();
            numbers.into_iter().collect()
        };
        self.groups().into_iter().map(of).collect()
    }

    /// Roots in order.
    pub(super) fn groups(&self) -> Vec<usize> {
        let mut roots: Vec<usize> = self.root.iter().flatten().copied().collect();
        roots.sort_unstable();
        roots.dedup();
        roots
    }
}

/// Refines all faces; joins loops that stay too near, and starts again from the coarse nets; brings faces that
/// share a group to one level, without which the thinnest place between two skins loses a third.
pub(super) fn refine_together(
    faces: &[Prepared],
    grouping: &mut Grouping,
    least: &mut [usize],
    scaling: &Scaling,
) -> Result<Vec<Refined>, ScaleError> {
    loop {
        let mut refined = Vec::with_capacity(faces.len());
        for (k, face) in faces.iter().enumerate() {
            refined.push(refine(face, &grouping.root[k], least[k], scaling)?);
        }
        let near: Vec<(usize, usize)> = refined
            .iter()
            .zip(&grouping.root)
            .flat_map(|(r, root)| r.near_pairs.iter().map(|&(a, b)| (root[a], root[b])))
            .collect();
        if !near.is_empty() {
            near.iter().for_each(|&(a, b)| grouping.join_roots(a, b));
            continue;
        }
        if !level_up(&refined, grouping, least) {
            return Ok(refined);
        }
    }
}

/// Raises the least levels to the greatest level of the faces that share a group; whether any rose.
fn level_up(refined: &[Refined], grouping: &Grouping, least: &mut [usize]) -> bool {
    let mut rose = false;
    for group in grouping.groups() {
        let on: Vec<usize> = (0..refined.len()).filter(|&k| grouping.root[k].contains(&group)).collect();
        let level = on.iter().map(|&k| refined[k].level).max().unwrap_or(0);
        for k in on {
            if refined[k].level < level && least[k] < level {
                least[k] = level;
                rose = true;
            }
        }
    }
    rose
}
