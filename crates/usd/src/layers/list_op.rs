//! Lists that change weaker lists: prepend, append, delete, or replace.

/// A list, or changes to a weaker list.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ListOp<T> {
    /// Replaces all weaker ones.
    pub(crate) explicit: Option<Vec<T>>,
    pub(crate) prepended: Vec<T>,
    /// Appended, or added in the older spelling.
    pub(crate) appended: Vec<T>,
    pub(crate) deleted: Vec<T>,
}

impl<T> Default for ListOp<T> {
    fn default() -> ListOp<T> {
        ListOp { explicit: None, prepended: Vec::new(), appended: Vec::new(), deleted: Vec::new() }
    }
}

impl<T: Clone + PartialEq> ListOp<T> {
    pub(crate) fn explicit(list: Vec<T>) -> ListOp<T> {
        ListOp { explicit: Some(list), ..ListOp::default() }
    }

    /// Adds what another statement in the same spec says.
    pub(crate) fn merge(&mut self, other: ListOp<T>) {
        if other.explicit.is_some() {
            self.explicit = other.explicit;
        }
        self.prepended.extend(other.prepended);
        self.appended.extend(other.appended);
        self.deleted.extend(other.deleted);
    }

    /// Changes a weaker list.
    pub(crate) fn apply(&self, weaker: &mut Vec<T>) {
        if let Some(list) = &self.explicit {
            weaker.clone_from(list);
            return;
        }
        if self.prepended.is_empty() && self.appended.is_empty() && self.deleted.is_empty() {
            return;
        }
        let moves = |item: &T| {
            self.deleted.contains(item) || self.prepended.contains(item) || self.appended.contains(item)
        };
        let mut list: Vec<T> = Vec::new();
        let mut add = |item: &T| {
            if !list.contains(item) {
                list.push(item.clone());
            }
        };
        self.prepended.iter().for_each(&mut add);
        weaker.iter().filter(|item| !moves(item)).for_each(&mut add);
        list.retain(|item| !self.appended.contains(item));
        list.extend(self.appended.iter().cloned());
        *weaker = list;
    }

    pub(crate) fn map<U>(&self, mut to: impl FnMut(&T) -> Option<U>) -> ListOp<U> {
        let mut all = |list: &Vec<T>| list.iter().filter_map(&mut to).collect();
        ListOp {
            explicit: self.explicit.as_ref().map(&mut all),
            prepended: all(&self.prepended),
            appended: all(&self.appended),
            deleted: all(&self.deleted),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_change_weaker_lists() {
        let change = |op: ListOp<u8>| {
            let mut list = vec![1, 2, 3];
            op.apply(&mut list);
            list
        };
        let none = ListOp::<u8>::default;
        assert_eq!(change(none()), [1, 2, 3]);
        assert_eq!(change(ListOp::explicit(vec![9])), [9]);
        assert_eq!(change(ListOp { prepended: vec![3, 7], ..none() }), [3, 7, 1, 2]);
        assert_eq!(change(ListOp { appended: vec![1, 8], ..none() }), [2, 3, 1, 8]);
        assert_eq!(change(ListOp { deleted: vec![2], appended: vec![4], ..none() }), [1, 3, 4]);
    }
}
