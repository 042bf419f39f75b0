//! The pressure for a wanted contact area.
