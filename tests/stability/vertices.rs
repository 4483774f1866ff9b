//! Numbers that are no places.
