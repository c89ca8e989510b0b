# Run by ctest as: cmake -DSOURCE=<root> -DSCRATCH=<folder> -DJOBS=<n> -P ...
# Configures, builds and installs core/ without the rest of the tree, then
# builds and runs a project that finds it with find_package. What was compiled
# stays in SCRATCH for the next time; the installed files do not.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(prefix ${SCRATCH}/prefix)
file(REMOVE_RECURSE ${prefix} ${SCRATCH}/consumer)

# Unoptimised: what is tested is that it builds.
set(options -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0)
run(${CMAKE_COMMAND} -S ${SOURCE}/core -B ${SCRATCH}/core ${options}
    -DCMAKE_INSTALL_PREFIX=${prefix})
run(${CMAKE_COMMAND} --build ${SCRATCH}/core -j ${JOBS})
run(${CMAKE_COMMAND} --install ${SCRATCH}/core)

run(${CMAKE_COMMAND} -S ${SOURCE}/tests/architecture/core_consumer
    -B ${SCRATCH}/consumer ${options} -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${SCRATCH}/consumer -j ${JOBS})
run(${SCRATCH}/consumer/core_consumer)
