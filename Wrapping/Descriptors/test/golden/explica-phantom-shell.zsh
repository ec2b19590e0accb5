  'phantom shell')
    _arguments \
      '--size[voxels along the first axis (8 to 1024; default 64)]:size: ' \
      '--spacing[voxel size along the first axis (mm; default 1)]:spacing: ' \
      '--inner-radius[inner radius over half the grid'\''s width (default 0.5)]:inner-radius: ' \
      '--outer-radius[outer radius over half the grid'\''s width (default 0.8)]:outer-radius: ' \
      '--aspect[voxel size along each axis over --spacing (default 1,1,1)]:aspect: ' \
      '--out[folder for the results; made if absent, refused if not empty]:out:_files' \
      '--force[write into a folder that is not empty, replacing earlier results]' \
      '--config[JSON file with option values; the command line wins]:config:_files' \
      '--threads[processors to use (default\: all that this process may) (1 to 4096)]:threads: ' \
      '--max-time[ask for an end after this time, with what was reached (s; above 0, at most 1,000,000,000)]:max-time: ' \
      '--max-memory[memory at most (MB; 64 to 1,073,741,824)]:max-memory: ' \
      '--dry-run[resolve and check everything, print the options, write nothing]' \
      '--quiet[say nothing but warnings and errors]' \
      '--verbose[say more]' \
      '--log[file to which every message goes, with times]:log:_files' \
      '--private[leave host, user and absolute paths out of the record]' \
      '--report[write report.html, a page on the results, too]' \
      '*:file:_files'
    ;;
