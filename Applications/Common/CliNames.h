#pragma once

/// The names of CLI11's that our headers need. CLI11's own header makes objects in every file that
/// includes it, which takes the compiler 6 s or more: only files that declare or look at options
/// do.
namespace CLI {

class App;
class Option;
class ParseError;

}  // namespace CLI
