//! Who uses whom in a file, the other way round: one compressed table of positions.
//!
//! Does not find the uses: each format knows its own references.

/// Users of each item of a file, by position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Users {
    /// `users[starts[p]..starts[p + 1]]` use the item at position `p`.
    starts: Vec<u32>,
    users: Vec<u32>,
}

impl Users {
    /// The table of `count` items. `each` calls what it is given with target and user for every use, all uses of one user
    /// in a row and users in ascending order; it is called twice. A use that comes again counts once.
    ///
    /// # Panics
    /// When a target is not below `count`.
    #[must_use]
    pub fn of(count: u32, each: impl Fn(&mut dyn FnMut(u32, u32))) -> Self {
        let count = count as usize;
        let mut starts = vec![0_u32; count + 1];
        once(count, &each, |target, _| starts[target as usize + 1] += 1);
        for position in 0..count {
            starts[position + 1] += starts[position];
        }
        let mut next = starts.clone();
        let mut users = vec![0_u32; starts[count] as usize];
        once(count, &each, |target, user| {
            let slot = &mut next[target as usize];
            users[*slot as usize] = user;
            *slot += 1;
        });
        Self { starts, users }
    }

    /// Positions of the users of the item at `position`, ascending, each once; none for a position beyond the file.
    #[must_use]
    pub fn at(&self, position: u32) -> &[u32] {
        let position = position as usize;
        match (self.starts.get(position), self.starts.get(position + 1)) {
            (Some(&start), Some(&end)) => &self.users[start as usize..end as usize],
            _ => &[],
        }
    }
}

/// Hands on each pair of target and user once.
fn once(count: usize, each: &impl Fn(&mut dyn FnMut(u32, u32)), mut found: impl FnMut(u32, u32)) {
    const NEVER: u32 = u32::MAX;
    let mut last_user = vec![NEVER; count];
    each(&mut |target, user| {
        if last_user[target as usize] != user {
            last_user[target as usize] = user;
            found(target, user);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn users_are_ascending_and_stand_once() {
        let uses = [(2, 0), (1, 0), (2, 0), (2, 1), (0, 3), (2, 3)];
        let users = Users::of(4, |found| uses.iter().for_each(|&(target, user)| found(target, user)));
        let found: Vec<&[u32]> = (0..5).map(|position| users.at(position)).collect();
        assert_eq!(found, [&[3][..], &[0], &[0, 1, 3], &[], &[]]);
    }
}
