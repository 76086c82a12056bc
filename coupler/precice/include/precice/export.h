#pragma once

/* Marks what the library offers to other programs. */
#define PRECICE_API __attribute__((visibility("default")))
