//! A share of the parts for each of several machines, the same on all of them.

use std::path::PathBuf;
use std::str::FromStr;

use crate::job::plan::Part;
use crate::job::report::Shard;

/// Which share a process does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// That of a number.
    Fixed(Shard),
    /// That of the array job's index in the environment, one of so many.
    Auto(usize),
}

/// Indices of array jobs, each from 0: Slurm's, Kubernetes', AWS Batch's.
const INDICES: [&str; 3] = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX", "AWS_BATCH_JOB_ARRAY_INDEX"];

/// More machines than there are anywhere.
const MOST: usize = 1_000_000;

impl FromStr for Share {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!("`{text}` is no share; expected `I/N` with I from 1 to N, or `auto/N` in an array job")
        };
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let count = count.parse().ok().filter(|count| (1..=MOST).contains(count)).ok_or_else(wrong)?;
        if index == "auto" {
            return Ok(Self::Auto(count));
        }
        let index = index.parse().ok().filter(|index| (1..=count).contains(index)).ok_or_else(wrong)?;
        Ok(Self::Fixed(Shard { index, count }))
    }
}

impl Share {
    /// The share, with the index looked up where the environment has it.
    ///
    /// # Errors
    /// A text for the user when the environment has no index, or one beyond the count.
    pub fn resolve(self) -> Result<Shard, String> {
        match self {
            Self::Fixed(shard) => Ok(shard),
            Self::Auto(count) => {
                let set = INDICES.iter().find_map(|name| Some((*name, std::env::var(name).ok()?)));
                let (name, text) = set.ok_or_else(|| {
                    format!("`auto/{count}` needs the index of an array job in {}", INDICES.join(", "))
                })?;
                of_index(&text, count).ok_or_else(|| {
                    let last = count - 1;
                    format!("{name} is `{text}`, and `auto/{count}` needs an index from 0 to {last}, such as `--array=0-{last}` sets")
                })
            }
        }
    }
}

fn of_index(text: &str, count: usize) -> Option<Shard> {
    let index = text.trim().parse::<usize>().ok().filter(|index| *index < count)?;
    Some(Shard { index: index + 1, count })
}

/// Parts with their sizes in bytes.
pub(super) type Sized = [(Part, u64)];

/// Numbers of the parts of each share: the largest part first, each to the share that has least so far. Depends on
/// names and sizes alone, and no share has more than another's and the largest part's bytes together.
pub(super) fn split(parts: &Sized, count: usize) -> Vec<Vec<usize>> {
    let mut shares = vec![(0, Vec::new()); count];
    for at in largest_first(parts) {
        // The first of the least: a tie is always broken the same way. Empty files count a little.
        let least = (0..count).min_by_key(|&share| shares[share].0).unwrap_or(0);
        shares[least].0 += parts[at].1 + 1;
        shares[least].1.push(at);
    }
    shares
        .into_iter()
        .map(|(_, mut of_share)| {
            of_share.sort_unstable();
            of_share
        })
        .collect()
}

/// Numbers of the parts by size, the largest first, then by path.
pub(super) fn largest_first(parts: &Sized) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    let key = |at: usize| -> (std::cmp::Reverse<u64>, &PathBuf) {
        (std::cmp::Reverse(parts[at].1), &parts[at].0.input)
    };
    order.sort_by(|&a, &b| key(a).cmp(&key(b)));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn shares_are_read() {
        assert_eq!("2/4".parse(), Ok(Share::Fixed(Shard { index: 2, count: 4 })));
        assert_eq!("auto/4".parse(), Ok(Share::Auto(4)));
        for wrong in ["0/4", "5/4", "2", "2/0", "auto/0", "/4", "-1/4", "1/99999999999999999999"] {
            assert!(wrong.parse::<Share>().is_err(), "{wrong}");
        }
        assert_eq!(of_index("3", 4), Some(Shard { index: 4, count: 4 }));
        assert_eq!(of_index("4", 4), None);
    }

    proptest! {
        #[test]
        fn each_part_is_in_one_share_and_the_shares_are_level(
            sizes in proptest::collection::vec(0u64..1_000_000, 0..60), count in 1usize..12,
        ) {
            let part = |at: usize| Part { input: format!("{at}.step").into(), output: format!("out/{at}.step").into() };
            let parts: Vec<(Part, u64)> = sizes.iter().enumerate().map(|(at, &size)| (part(at), size)).collect();
            let shares = split(&parts, count);
            let mut all: Vec<usize> = shares.concat();
            all.sort_unstable();
            prop_assert_eq!(all, (0..parts.len()).collect::<Vec<_>>());
            let weight = |share: &Vec<usize>| share.iter().map(|&at| sizes[at] + 1).sum::<u64>();
            let weights: Vec<u64> = shares.iter().map(weight).collect();
            let largest = sizes.iter().max().map_or(0, |size| size + 1);
            let (least, most) = (weights.iter().min().copied().unwrap_or(0), weights.iter().max().copied().unwrap_or(0));
            prop_assert!(most <= least + largest);
        }
    }
}
