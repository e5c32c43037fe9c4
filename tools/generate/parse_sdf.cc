// Parses SDF files with libsdformat and prints every error it finds.
#include <iostream>

#include <sdf/Root.hh>

int main(int argc, char **argv) {
  bool failed = false;
  for (int n = 1; n < argc; ++n) {
    sdf::Root root;
    for (const auto &error : root.Load(argv[n])) {
      failed = true;
      std::cout << argv[n] << ": " << error << "\n";
    }
  }
  return failed ? 1 : 0;
}
