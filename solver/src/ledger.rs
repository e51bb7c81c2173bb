//! Energy ledger.
